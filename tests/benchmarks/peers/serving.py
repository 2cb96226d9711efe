"""Does the work of a job whenever a line comes in; standard output gets the time and the answer."""

import json
import sys
import time


def serve(work, prepare=tuple):
    """Answer every line with nanoseconds of processor time and what the work has found.

    What ``prepare`` returns the work gets as its arguments; making it is not measured.
    """
    for _ in sys.stdin:
        made = prepare()
        start = time.process_time_ns()
        found = work(*made)
        taken = time.process_time_ns() - start
        sys.stdout.write(json.dumps([taken, found]) + "\n")
        sys.stdout.flush()
