"""Lets ``python -m rulec`` run the command line."""

import sys

from rulec.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
