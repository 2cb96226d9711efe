"""Scores of futures: verdicts, penalties, places, a guard and a reward."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence, Set
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy import bool_, float64, intp
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import did_you_mean
from rulec.diagnostics.argument_kinds import expected, finite
from rulec.diagnostics.fault_messages import contained
from rulec.diagnostics.phrases import first_of
from rulec.monitoring.verdict import Violation
from rulec.planning.ranking.penalties import PenaltyOrder, PenaltyRank, ranks_of
from rulec.scoring.candidate_score import CandidateScore
from rulec.scoring.charges import CandidateScores, Charged, ScoreColumns, columns_of, traces_of
from rulec.scoring.score_margins import RuleMargin, margins_of
from rulec.trace.trace_arrays import TraceArrays
from rulec.value_display import Rows

_MOST_WORTH = 1_000_000
_MOST_WORDS = 3


@dataclass(frozen=True, eq=False)
class Scores(Rows):
    """The scores of candidates, in their order, and their comparison.

    ``paths`` are the candidates' states: candidate, state, and x, y (m), heading (rad), speed
    (m/s). ``violated_before`` are the violations of the past alone: for these rules and objects,
    candidates are judged by the second half of their states, as if nothing had been before.
    """

    rules: CompiledRulebook = field(repr=False)
    candidates: Sequence[CandidateScore]
    violated_before: tuple[Violation, ...]
    paths: NDArray[float64] = field(repr=False)
    _first: int = field(repr=False)

    def __repr__(self) -> str:
        said = f"{self.rules.name}: {int(self.allowed.sum())} of {len(self)} allowed"
        untold = {rule.rule: rule.untold for score in self.candidates for rule in score.not_judged}
        if untold:
            said += f"; {len(untold)} of {len(self.rules.rules)} rules not judged"
            wanting = Counter(word for words in untold.values() for word in words)
            words = sorted(wanting, key=lambda word: (-wanting[word], word))
            lack = first_of([f"{word} ({wanting[word]})" for word in words], _MOST_WORDS)
            said += f" for lack of {lack}" if lack else ""
        return f"Scores({said})"

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
        """The weights of what each candidate (row) surely violates, by rank (column)."""
        return self._weights(self._columns.violated)

    @cached_property
    def penalties_at_most(self) -> NDArray[float64]:
        """Like ``penalties``, with open rules counted as violated."""
        return self._weights(self._columns.violated, self._columns.open)

    @cached_property
    def off_road(self) -> NDArray[intp]:
        """Per candidate, the number of states on no lane in its direction, or beside all lanes."""
        return self._columns.off_road

    @cached_property
    def allowed(self) -> NDArray[bool_]:
        """Mask of the candidates that stay on the road, with no hard rule violated or open.

        An open rule may be violated: straddling two lanes must not be an advantage. Rules that
        cannot be judged in this world, for any candidate, and what the past leaves open do not
        count.
        """
        return self.perhaps_allowed & ~self._are_hard(self._columns.open)

    @cached_property
    def perhaps_allowed(self) -> NDArray[bool_]:
        """Mask of the candidates that stay on the road, with no hard rule surely violated."""
        allowed: NDArray[bool_] = ~self._are_hard(self._columns.violated) & (self.off_road == 0)
        return allowed

    @cached_property
    def places(self) -> NDArray[intp]:
        """The place of each candidate: 1 if none violates less, else 1 more than those that do.

        Compared are, in this order: states off the road (fewer first), penalties with open rules
        counted as violated, penalties of sure violations, and ``late`` states.
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
        """The number of the least violating candidate, the first one of equals."""
        first = (self.places == 1).nonzero()[0]
        return int(first[0])

    @property
    def best_path(self) -> NDArray[float64]:
        """The states of the least violating candidate: x, y (m), heading (rad), speed (m/s)."""
        path: NDArray[float64] = self.paths[self.best]
        return path

    def reward(self, worth: float = 10.0) -> NDArray[float64]:
        """A number for each candidate: 0 if it violates nothing, otherwise less.

        Each rank counts ``worth`` times the next lower one, the lowest 1, and a state off the road
        ``worth`` times the highest rank; open rules count as violated. The share of ``late`` states
        (below 1) is subtracted. Raises ValueError for a worth with which a rank would count less
        than a lower one.
        """
        finite("worth", expected("worth", "float", worth))
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
        """The allowed candidate nearest to one: itself if it is allowed, None if none is.

        By the mean distance (m) of their places. Raises IndexError for an unknown number.
        """
        number = self._known(number)
        if self.allowed[number]:
            return number
        allowed = self.allowed.nonzero()[0]
        if not len(allowed):
            return None
        away = np.hypot(*np.moveaxis(self.paths[allowed, :, :2] - self.paths[number, :, :2], -1, 0))
        return int(allowed[away.mean(axis=1).argmin()])

    def margins(self, number: int) -> tuple[RuleMargin, ...]:
        """By how much a candidate violates or keeps rules, in their units, where numbers decide.

        Raises IndexError for an unknown number.
        """
        score = self.candidates[self._known(number)]
        with contained(f"margins of candidate {number}"):
            return tuple(margins_of(score, self.violated_before, self.rules, self._first))

    def _known(self, number: int) -> int:
        """A candidate's number, checked; a negative one would be a bug in a planner's loop."""
        if not 0 <= expected("number", "int", number) < len(self):
            raise IndexError(f"candidates are numbered from 0 to {len(self) - 1}, not {number}")
        return int(number)

    def rows(self) -> list[dict[str, Any]]:
        """One row for each candidate."""
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
        """The outcome of a rule for each candidate: kept, violated, open or not judged.

        It is the worst for all choices of objects. Raises ValueError for an unknown rule.
        """
        known = [compiled_rule.name for compiled_rule in self.rules.rules]
        if expected("rule", "str", rule) not in known:
            hint = did_you_mean(rule, known)
            raise ValueError(f"{self.rules.name} has no rule `{rule:.40}`" + (hint and f"; {hint}"))
        return [_outcome(score, rule) for score in self.candidates]

    def traces_of(self, number: int) -> list[TraceArrays]:
        """The judged drives of a candidate, without making their verdicts."""
        known = self.candidates
        return traces_of(
            known.charges[number] if isinstance(known, CandidateScores) else known[number]
        )

    @cached_property
    def open_rules(self) -> Sequence[Set[str]]:
        """The names of the rules that are charged to each candidate as open."""
        found: list[set[str]] = [set() for _ in range(len(self))]
        for candidate, rule in zip(*(own.tolist() for own in self._columns.open), strict=True):
            found[candidate].add(self.rules.rules[rule].name)
        return found

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
        """Mask of the charges that are about hard rules."""
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
    return "not judged" if not_judged or not found.is_judged else "kept"
