"""Results about maneuvers beside their number."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.monitoring.verdict import Violation
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.ranking.penalties import PenaltyRank
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class RankedManeuver:
    """A maneuver beside others by what it violates: see ``docs/ranking.md``.

    ``place`` is 1 if no maneuver violates less, else 1 more than the last place of those that do.
    ``penalty`` are the weights of what it violates, summed up by rank, ranks without any left out.
    So many ``members`` have this penalty; of them this is one of the cheapest.
    """

    __repr__ = short_repr

    place: int
    penalty: Mapping[PenaltyRank, Fraction]
    members: int
    maneuver: Maneuver
    violations: tuple[Violation, ...]


@dataclass(frozen=True, slots=True)
class RulePruning:
    """Numbers of maneuvers that violate a rule, and that rule alone.

    The latter is None for a soft rule: it rejects nothing. The example is one of the cheapest of
    the latter, if there are any, else of the former; None if there are none of these either. The
    violations are those of the rule by the example.
    """

    __repr__ = short_repr

    rule: CompiledRule
    violating: int
    alone: int | None
    example: Maneuver | None
    violations: tuple[Violation, ...]
