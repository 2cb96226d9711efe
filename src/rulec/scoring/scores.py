"""What futures come to: verdicts, penalties, places, a guard and a reward."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy import bool_, float64, intp
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import did_you_mean
from rulec.diagnostics.argument_kinds import expected, finite
from rulec.extraction.recording_verdicts import DriveVerdict
from rulec.monitoring.verdict import Violation
from rulec.planning.ranking.penalties import PenaltyOrder, PenaltyRank, ranks_of
from rulec.scoring.candidate_score import CandidateScore
from rulec.scoring.charges import Charged, ScoreColumns, columns_of
from rulec.scoring.score_margins import RuleMargin, margins_of
from rulec.value_display import Rows

_MOST_WORTH = 1_000_000


@dataclass(frozen=True, eq=False)
class Scores(Rows):
    """What candidates come to, in their order, and how they compare.

    ``paths`` are their states: candidate, state, and x, y (m), heading (rad), speed (m/s).
    ``violated_before`` is what the past has violated by itself: of these rules, for these objects,
    candidates are judged by the second half of their states, as if nothing had been before.
    """

    rules: CompiledRulebook = field(repr=False)
    candidates: Sequence[CandidateScore]
    violated_before: tuple[Violation, ...]
    paths: NDArray[float64] = field(repr=False)
    _first: int = field(repr=False)

    def __repr__(self) -> str:
        return f"Scores({self.rules.name}: {int(self.allowed.sum())} of {len(self)} allowed)"

    def __len__(self) -> int:
        return len(self.candidates)

    @cached_property
    def _order(self) -> PenaltyOrder:
        return ranks_of(self.rules)

    @property
    def ranks(self) -> tuple[PenaltyRank, ...]:
        """The levels of the rules, hard ones first: the columns of penalties."""
        return self._order.ranks

    @cached_property
    def penalties(self) -> NDArray[float64]:
        """The weights of what each candidate (row) violates for sure, by rank (column)."""
        return self._weights(self._columns.violated)

    @cached_property
    def penalties_at_most(self) -> NDArray[float64]:
        """The same with what is open, as if that were violated."""
        return self._weights(self._columns.violated, self._columns.open)

    @cached_property
    def off_road(self) -> NDArray[intp]:
        """How many states of each candidate are on no lane that leads its way, or beside all."""
        return self._columns.off_road

    @cached_property
    def allowed(self) -> NDArray[bool_]:
        """Flags of candidates that stay on the road, and of which no hard rule is violated or open.

        What is open may be violated: who straddles two lanes shall gain nothing by it.
        """
        return self.perhaps_allowed & ~self._are_hard(self._columns.open)

    @cached_property
    def perhaps_allowed(self) -> NDArray[bool_]:
        """Flags of candidates that stay on the road, and violate no hard rule for sure."""
        allowed: NDArray[bool_] = ~self._are_hard(self._columns.violated) & (self.off_road == 0)
        return allowed

    @cached_property
    def places(self) -> NDArray[intp]:
        """The place of each candidate: 1 if none violates less, else 1 more than those that do.

        Fewer states off the road come first, then the order of penalties, what is open counting as
        violated, then that of what is violated for sure, then who is less ``late``.
        """
        places = np.zeros(len(self), dtype=intp)
        kinds = list(zip(*self._comparable, strict=True))
        known: dict[Any, int] = {}
        for kind in sorted(set(kinds)):
            less = [known[other] for other in known if self._is_less(other, kind)]
            known[kind] = max(less, default=0) + 1
        for number, kind in enumerate(kinds):
            places[number] = known[kind]
        return places

    @property
    def best(self) -> int:
        """The number of the least violating candidate, the first of those that are alike."""
        first = (self.places == 1).nonzero()[0]
        return int(first[0])

    def reward(self, worth: float = 10.0) -> NDArray[float64]:
        """A number for each candidate, 0 for one that violates nothing, else less.

        Each rank counts ``worth`` times the highest one below it, the lowest 1, and a state off the
        road ``worth`` times the highest of all; what is open counts as violated. It is less by the
        share of its states, below 1, for which a candidate is ``late``. Raises ValueError for a
        worth by which a rank would count less than one below it.
        """
        finite("worth", worth)
        if not 1 <= worth <= _MOST_WORTH:
            raise ValueError(f"`worth` is a number from 1 to {_MOST_WORTH:,}, not {worth:g}")
        above = self._order.above
        depths = [0] * len(above)
        for rank in reversed(range(len(above))):
            below = [depths[k] + 1 for k in range(len(above)) if rank in above[k]]
            depths[rank] = max(below, default=0)
        factors = np.array([float(worth) ** depth for depth in depths])
        beyond = float(worth) ** (max(depths, default=0) + 1)
        late = self._columns.late / (self.paths.shape[1] + 1)
        charged = self.penalties_at_most @ factors + beyond * self.off_road + late
        rewards: NDArray[float64] = -charged
        return rewards + 0.0

    def nearest_allowed(self, number: int) -> int | None:
        """The allowed candidate nearest to one: itself if it is, None if there is none.

        By the mean distance (m) of their places. Raises IndexError for a number that there is not.
        """
        number = self._known(number)
        allowed = self.allowed.nonzero()[0]
        if not len(allowed):
            return None
        away = np.hypot(*np.moveaxis(self.paths[allowed, :, :2] - self.paths[number, :, :2], -1, 0))
        return int(allowed[away.mean(axis=1).argmin()])

    def margins(self, number: int) -> tuple[RuleMargin, ...]:
        """By how much a candidate violates or keeps rules, in their units, where numbers decide.

        Raises IndexError for a number that there is not.
        """
        score = self.candidates[self._known(number)]
        drives = [drive for drive in score.drives if isinstance(drive, DriveVerdict)]
        return tuple(margins_of(drives, score.violations, self.rules, self._first))

    def _known(self, number: int) -> int:
        """The number of a candidate; one from the end would be a slip in a planner's loop."""
        if not 0 <= expected("number", "int", number) < len(self):
            raise IndexError(f"candidates are numbered from 0 to {len(self) - 1}, not {number}")
        return int(number)

    def rows(self) -> list[dict[str, Any]]:
        """One row a candidate."""
        return [
            {
                "candidate": score.number,
                "place": place,
                "satisfied": score.satisfied,
                "violated": [violation.rule for violation in score.violations],
                "open": [result.rule for result in score.open],
                "off_road": score.off_road,
                "why": score.why,
            }
            for score, place in zip(self.candidates, self.places.tolist(), strict=True)
        ]

    def outcomes(self, rule: str) -> list[str]:
        """What each candidate does to a rule: kept, violated, open or not judged.

        The worst for all choices of objects. Raises ValueError for a rule that there is not.
        """
        known = [compiled_rule.name for compiled_rule in self.rules.rules]
        if expected("rule", "str", rule) not in known:
            hint = did_you_mean(rule, known)
            raise ValueError(f"{self.rules.name} has no rule `{rule:.40}`" + (hint and f"; {hint}"))
        return [_outcome(score, rule) for score in self.candidates]

    @cached_property
    def _columns(self) -> ScoreColumns:
        return columns_of(self.candidates, self.rules)

    def _weights(self, *charged: Charged) -> NDArray[float64]:
        ranks = np.array([self._order.of(rule) for rule in self.rules.rules], dtype=intp)
        weights = np.array([float(rule.weight) for rule in self.rules.rules])
        penalties = np.zeros((len(self), len(self.ranks)))
        for whose, rules in charged:
            np.add.at(penalties, (whose, ranks[rules]), weights[rules])
        return penalties

    def _are_hard(self, charged: Charged) -> NDArray[bool_]:
        """Flags of candidates that are charged with hard rules."""
        are_hard = np.array([rule.strength == "hard" for rule in self.rules.rules], dtype=bool)
        found = np.zeros(len(self), dtype=bool)
        found[charged.candidates[are_hard[charged.rules]]] = True
        return found

    @property
    def _comparable(self) -> tuple[Sequence[Any], ...]:
        """For each candidate: states off the road, penalties at most and for sure, late states."""
        unit = float(self._order.unit)

        def whole(penalties: NDArray[float64]) -> list[tuple[int, ...]]:
            return [tuple(row) for row in np.rint(penalties / unit).astype(int).tolist()]

        late = self._columns.late.tolist()
        return self.off_road.tolist(), whole(self.penalties_at_most), whole(self.penalties), late

    def _is_less(self, one: Any, other: Any) -> bool:
        if one[0] != other[0]:
            return bool(one[0] < other[0])
        for own, theirs in zip(one[1:3], other[1:3], strict=True):
            if own != theirs:
                return self._order.at_most(own, theirs)
        return bool(one[3] < other[3])


def _outcome(found: CandidateScore, rule: str) -> str:
    if any(violation.rule == rule for violation in found.violations):
        return "violated"
    if any(result.rule == rule for result in found.open):
        return "open"
    not_judged = any(result.rule == rule for result in found.not_judged)
    return "not judged" if not_judged or not found.drives else "kept"
