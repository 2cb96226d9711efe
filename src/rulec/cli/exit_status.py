"""Exit statuses of rulec's commands."""

from __future__ import annotations

from enum import IntEnum


class ExitStatus(IntEnum):
    """The exit statuses of all commands, as listed in docs/commands.md."""

    OK = 0
    """Done; what was judged is satisfied."""
    VIOLATED = 1
    """A hard rule is violated, or no maneuver satisfies all of them."""
    FOUND = 1
    """A rulebook has mistakes, or an example's verdict is not the stated one."""
    NOT_ANSWERED = 2
    """The question could not be answered: wrong usage, bad input, output that cannot be written."""
    BUG = 70
    """A bug in rulec."""
    INTERRUPTED = 130
    """Ctrl-C."""
    READER_GONE = 141
    """The reader of the output, such as ``head``, is gone: no verdict either way."""

    @classmethod
    def after(cls, *, answered: bool = True, failed: bool) -> ExitStatus:
        """The status of a question: an incomplete answer comes before a failure."""
        if not answered:
            return cls.NOT_ANSWERED
        return cls.FOUND if failed else cls.OK
