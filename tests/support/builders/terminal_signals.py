"""Processes that hear signals as if they were started from a terminal."""

import signal


def as_from_a_terminal():
    """For ``preexec_fn``. What runs in the background may have been told to ignore these signals,
    and its children inherit that; a shell could not even undo it."""
    for number in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)
