"""Errors for questions that are too large or not supported."""

from __future__ import annotations


class UndecidedError(Exception):
    """The question is left undecided; the text gives the reason as a clause."""


class ChangingConstantsError(UndecidedError):
    """The shortest words change what is constant in a trace; other words may not.

    ``subjects`` are the declarations, and their objects, whose values would have to change.
    """

    def __init__(self, subjects: tuple[tuple[str, tuple[str, ...]], ...]) -> None:
        quoted = ", ".join(f"`{name}`" for name in dict.fromkeys(name for name, _ in subjects))
        super().__init__(f"{quoted}, which cannot change, would have to")
        self.subjects = subjects
