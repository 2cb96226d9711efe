"""Exit statuses of rulec's commands."""

from __future__ import annotations

from enum import IntEnum


class ExitStatus(IntEnum):
    """The exit status of every command, as docs/commands.md lists them."""

    OK = 0
    """Done; what was judged is satisfied."""
    VIOLATED = 1
    """A hard rule is violated, or no maneuver satisfies all of them."""
    FOUND = 1
    """There are mistakes in a rulebook, or its examples come out otherwise than they say."""
    NOT_ANSWERED = 2
    """The question could not be answered: wrong usage, bad input, output that cannot be written."""
    BUG = 70
    """A mistake in rulec itself."""
    INTERRUPTED = 130
    """Ctrl-C."""
    READER_GONE = 141
    """Who read the output, such as ``head``, has left: no verdict either way."""

    @classmethod
    def after(cls, *, answered: bool = True, failed: bool) -> ExitStatus:
        """The status of a question: an incomplete answer comes before a failure."""
        if not answered:
            return cls.NOT_ANSWERED
        return cls.FOUND if failed else cls.OK
