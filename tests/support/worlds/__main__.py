"""The table of simulated worlds: which verdicts are right, by kind of world and rule.

`.ci/task worlds [--kind K] [--seeds N]`; with ``--store`` the stored worlds are made anew.
"""

import argparse
import tempfile
from pathlib import Path

from support.worlds.judging import DISTURBANCES, Run, judged_all, judged_recordings, judged_stored
from support.worlds.scoring import table
from support.worlds.stored import SMALL, StoredWorld
from support.worlds.sumo_environment import sumo_programs
from support.worlds.world_kinds import KINDS


def main():
    parser = argparse.ArgumentParser(prog=".ci/task worlds", description=__doc__)
    parser.add_argument("--kind", action="append", choices=list(KINDS))
    parser.add_argument("--seeds", type=int, default=3, help="how many of each kind")
    parser.add_argument("--first", type=int, default=1, metavar="SEED", help="the first of them")
    parser.add_argument("--jobs", type=int, default=2, help="how many at the same time")
    parser.add_argument("--results", type=Path, help="a folder: worlds in it are not judged again")
    parser.add_argument("--as", dest="disturbance", choices=list(DISTURBANCES))
    parser.add_argument("--keep", type=Path, help="a folder for the files of the worlds")
    parser.add_argument("--stored", action="store_true", help="judge the stored worlds alone")
    parser.add_argument("--recordings", type=Path, nargs="+", help="CommonRoad files, by labels")
    parser.add_argument("--store", action="store_true", help="make the stored worlds anew")
    words = parser.parse_args()
    if words.store:
        with tempfile.TemporaryDirectory() as folder:
            for name in SMALL:
                StoredWorld(name).store(sumo_programs(), Path(folder) / name)
        return
    if words.recordings:
        total = judged_recordings(words.recordings)
    elif words.stored:
        total = judged_stored()
    else:
        # A world of each kind before the next of any: whoever stops it has seen them all
        seeds = range(words.first, words.first + words.seeds)
        worlds = [(kind, seed) for seed in seeds for kind in words.kind or KINDS]
        named = {name: getattr(words, name) for name in ("disturbance", "keep", "results")}
        total = judged_all(Run(sumo=sumo_programs(), processes=words.jobs, **named), worlds)
    print("\n".join(table(total)))
    for by_rule in total.values():
        for score in by_rule.values():
            for what in ("false", "missed", "open"):
                for line in getattr(score, what):
                    print(f"{what:7} {line}")


if __name__ == "__main__":
    main()
