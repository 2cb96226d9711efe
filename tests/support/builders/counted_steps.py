"""Steps of a program, which are the same on every machine; its time is not."""

import os
import sys


def steps(run):
    """How many lines of Python ``run()`` goes through."""
    count = 0

    def trace(frame, event, argument):
        nonlocal count
        count += event == "line"
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        run()
    finally:
        sys.settrace(before)
    return count


def grows_in_proportion(run, size):
    """Does ``run(2 * size)`` take about twice the steps of ``run(size)``, or fewer?

    The quick profile tries sizes of half, since counting makes a program many times slower.
    """
    if os.environ.get("RULEC_TEST_PROFILE") != "long":
        size //= 2
    run(1)  # what is done once, such as reading the grammar, does not count
    return steps(lambda: run(2 * size)) < 2.3 * steps(lambda: run(size))
