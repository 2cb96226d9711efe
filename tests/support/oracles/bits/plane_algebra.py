"""What planes of bits can do.

A plane has a bit for each instant of one trace, or of many. A row has one for each trace: what is
the case at the first instant, or at any.
"""

from __future__ import annotations

from typing import Protocol, TypeVar

from rulec.logic.formula import Proposition

Plane = TypeVar("Plane")


class Algebra(Protocol[Plane]):
    """What planes can do. Nothing is the case before the first instant.

    After the last one the last goes on for ever, or, on finite words, nothing is the case.
    """

    def given(self, proposition: Proposition) -> Plane:
        """When an atom or a comparison is true."""

    def constant(self, value: bool) -> Plane:
        """The same at every instant."""

    def no(self, one: Plane) -> Plane:
        """Not."""

    def both(self, one: Plane, other: Plane) -> Plane:
        """And."""

    def either(self, one: Plane, other: Plane) -> Plane:
        """Or."""

    def differ(self, one: Plane, other: Plane) -> Plane:
        """Exclusive or."""

    def ahead(self, one: Plane, steps: int) -> Plane:
        """What is the case so many instants later."""

    def back(self, one: Plane, steps: int) -> Plane:
        """What was the case so many instants earlier."""

    def until(self, left: Plane | None, right: Plane) -> Plane:
        """``right`` now or later, and ``left`` at every instant from now to the one before.

        ``left`` is None if it is the case everywhere.
        """

    def since(self, left: Plane | None, right: Plane) -> Plane:
        """``right`` now or earlier, and ``left`` at every instant after that up to now.

        ``left`` is None if it is the case everywhere.
        """

    def given_first(self, proposition: Proposition) -> Plane:
        """The row of an atom or a comparison at the first instant."""

    def first(self, one: Plane) -> Plane:
        """The row of the first instant."""

    def ever(self, one: Plane) -> Plane:
        """The row of what is the case at any instant."""

    def opposite(self, row: Plane) -> Plane:
        """Not, of a row. ``both``, ``either`` and ``differ`` take rows as well as planes."""
