"""Makes ``python -m rulec`` run the command line."""

import sys

from rulec.cli.entry_point import run

if __name__ == "__main__":
    sys.exit(run())
