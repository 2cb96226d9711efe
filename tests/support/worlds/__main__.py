"""The table of simulated worlds: which verdicts are right, by kind of world and rule.

`.ci/task worlds [--kind K] [--seeds N]`; with ``--store`` the stored worlds are made anew.
"""

import argparse
import tempfile
from pathlib import Path

from support.worlds.judging import DISTURBANCES, judged_all, judged_recordings, judged_stored
from support.worlds.scoring import table
from support.worlds.stored import SMALL, StoredWorld
from support.worlds.sumo_environment import sumo_programs
from support.worlds.world_kinds import KINDS


def main():
    parser = argparse.ArgumentParser(prog=".ci/task worlds", description=__doc__)
    parser.add_argument("--kind", action="append", choices=list(KINDS))
    parser.add_argument("--seeds", type=int, default=3, help="how many of each kind")
    parser.add_argument("--as", dest="disturbance", choices=list(DISTURBANCES))
    parser.add_argument("--keep", type=Path, help="a folder for the files of the worlds")
    parser.add_argument("--stored", action="store_true", help="judge the stored worlds alone")
    parser.add_argument("--recordings", type=Path, nargs="+", help="CommonRoad files, by labels")
    parser.add_argument("--store", action="store_true", help="make the stored worlds anew")
    words = parser.parse_args()
    kinds, seeds = words.kind or list(KINDS), range(1, words.seeds + 1)
    with tempfile.TemporaryDirectory() as temporary:
        folder = words.keep or Path(temporary)
        if words.store:
            for name in SMALL:
                StoredWorld(name).store(sumo_programs(), folder / name)
            return
        if words.recordings:
            total = judged_recordings(words.recordings)
        elif words.stored:
            total = judged_stored()
        else:
            total = judged_all(sumo_programs(), kinds, seeds, folder, words.disturbance)
    print("\n".join(table(total)))
    for by_rule in total.values():
        for score in by_rule.values():
            for what in ("false", "missed"):
                for line in getattr(score, what):
                    print(f"{what:7} {line}")


if __name__ == "__main__":
    main()
