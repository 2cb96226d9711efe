"""Steps of a program, which are the same on every machine; its time is not."""

import os
import sys


def steps(run):
    """How many lines of Python ``run()`` goes through, and returns from functions."""
    count = 0

    def in_function(frame, event, argument):
        nonlocal count
        count += 1
        return in_function

    before = sys.gettrace()
    sys.settrace(lambda frame, event, argument: in_function)
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
    # What is done once, such as reading the grammar, does not count. The size is another one, so
    # that nothing kept from it makes what is counted shorter
    run(3 * size)
    return steps(lambda: run(2 * size)) < 2.3 * steps(lambda: run(size))
