"""The table of mistakes in files: by format, how many were read or refused, and what failed.

`.ci/task mutations [--inputs N] [--first SEED] [NAME …]`
"""

import argparse
import tempfile
from pathlib import Path

from support.mutations.format_samples import MAPS, RECORDINGS
from support.mutations.trial import read_as_map, read_as_recording, summary, tried


def main():
    parser = argparse.ArgumentParser(prog=".ci/task mutations", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="formats; `map:NAME` for maps")
    parser.add_argument("--inputs", type=int, default=20_000, help="how many of each format")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="the first of them")
    words = parser.parse_args()
    kinds = {
        **{name: (of, read_as_recording) for name, of in RECORDINGS.items()},
        **{f"map:{name}": (of, read_as_map) for name, of in MAPS.items()},
    }
    seeds = range(words.first, words.first + words.inputs)
    for name in words.names or kinds:
        samples, read = kinds[name]
        with tempfile.TemporaryDirectory() as folder:
            print(summary(tried(name, list(samples()), read, Path(folder), seeds)), flush=True)


if __name__ == "__main__":
    main()
