"""Verdicts as data, and what of a running trace affects later ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, TypeAlias

from rulec.diagnostics import RulecError
from rulec.rulebook.rulebook_model import Strength
from rulec.value_display import Rows, short_repr


@dataclass(frozen=True, slots=True)
class Violation:
    """A rule that a trace violates, for one binding of its variables.

    ``step`` is the first state (from 0) after which no continuation can save the rule; None if only
    the trace's end decides.
    """

    __repr__ = short_repr

    rule: str
    strength: Strength
    binding: Mapping[str, str]
    step: int | None


@dataclass(frozen=True, slots=True)
class Verdict(Rows):
    """Verdict of a rulebook: a trace's violations by rule and objects."""

    __repr__ = short_repr

    trace: str
    violations: tuple[Violation, ...]

    @property
    def satisfied(self) -> bool:
        """Tell whether no hard rule is violated; soft rules may be."""
        return all(violation.strength != "hard" for violation in self.violations)

    def rows(self) -> list[dict[str, Any]]:
        """One row a violation."""
        return [
            {
                "trace": self.trace,
                "rule": violation.rule,
                "strength": violation.strength,
                "step": violation.step,
                "binding": dict(violation.binding),
            }
            for violation in self.violations
        ]


@dataclass(frozen=True, slots=True)
class NotJudged:
    """Trace without a verdict: its id, if known, and the error."""

    __repr__ = short_repr

    trace: str | None
    error: RulecError


RuleFor: TypeAlias = tuple[str, tuple[str, ...]]
"""A rule's name, and the objects that its variables stand for."""


@dataclass(frozen=True, slots=True)
class CarriedState:
    """Machine states of objects that stay, and the permanent violations.

    ``settled`` are rules for objects that stay that are among the ``violations``.
    """

    states: Mapping[RuleFor, int] = field(default_factory=lambda: MappingProxyType({}))
    settled: frozenset[RuleFor] = frozenset()
    violations: tuple[Violation, ...] = ()


NO_PAST = CarriedState()
