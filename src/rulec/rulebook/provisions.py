"""Options, parameters and definitions of a rulebook, as its formulas find them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from rulec.rulebook.numbers import Number
from rulec.rulebook.overlay import Overlay
from rulec.syntax import tree


@dataclass(slots=True)
class Provisions:
    """What formulas may speak of besides the vocabulary, on the day ``at`` (ISO).

    ``numbers`` are the parameters' values, None for one that has none or a wrong one, filled as
    they are asked for.
    """

    overlay: Overlay
    at: str
    traffic: Literal["", "left", "right"] = ""
    numbers: dict[str, Number | None] = field(default_factory=dict)
    expansions: int = 0
    """How many definitions have been put into the formula at hand."""

    @property
    def options(self) -> Mapping[str, bool]:
        """Their values."""
        return self.overlay.options

    @property
    def definitions(self) -> Mapping[str, tree.DefineItem]:
        """By name."""
        return self.overlay.definitions

    def names(self) -> list[str]:
        """All of them."""
        found = self.overlay
        return [*found.options, *found.parameters, *found.definitions]

    def may_know(self, name: str) -> bool:
        """Could the name be given by what could not be read?"""
        return self.overlay.unsure or name in self.overlay.suspects


def in_force(dates: tree.InForce | None, day: str) -> bool:
    """Is something in force on a day (ISO)? The last day counts."""
    if dates is None:
        return True
    return dates.since <= day and (not dates.until or day <= dates.until)
