"""Formulas as functions of the current letter and of the obligations for the rest of the word.

The obligations are untils, one variable for each; a release is a negated until. A state of a
formula's progression (Bacchus, Kabanza, "Using temporal logic to control search in a forward
chaining planner", 1996) is a function of these variables alone.
"""

from __future__ import annotations

from typing import NamedTuple

from rulec.automata.decision_diagrams.diagrams import FALSE, TRUE, Diagrams
from rulec.logic import formula as ltl
from rulec.logic.bounds import Range
from rulec.logic.fold import Algebra, fold, temporal_operation


class _Until(NamedTuple):
    """An until of two functions, with what remains of its range."""

    left: int
    right: int
    span: Range


class PendingUntils:
    """The untils that formulas leave for the rest of a word, as variables of diagrams.

    Operands of untils are functions, so equivalent untils are one. Their variables are ordered
    after those of letters.
    """

    def __init__(self, diagrams: Diagrams) -> None:
        self._diagrams = diagrams
        self._names: dict[_Until, str] = {}
        self._untils: dict[str, _Until] = {}
        self._unfolded: dict[str, int] = {}
        self._progressed: dict[int, int] = {1: 1}
        self._smallest: dict[int, int] = {1: 1}
        self._families: dict[tuple[int, int], dict[str, float]] = {}
        self._known: dict[ltl.Formula, int] = {}

    def function_of(self, formula: ltl.Formula) -> int:
        """What a formula demands of the current letter and of the rest of the word.

        It has no past operator, and its bounds are in steps.
        """
        given = self._diagrams.algebra()
        algebra: Algebra[int] = Algebra(
            proposition=given.proposition,
            constant=given.constant,
            negation=given.negation,
            conjunction=given.conjunction,
            disjunction=given.disjunction,
            equivalence=given.equivalence,
            operation=temporal_operation(
                lambda function: -function,
                until=self._until,
                release=self._release,
                weak_until=self._weak_until,
                strong_release=lambda left, right, span: -self._weak_until(-left, -right, span),
            ),
        )
        return fold(formula, algebra, self._known)

    def progressed(self, state: int) -> int:
        """What a state demands of the next letter and of the rest after it."""
        known = self._progressed.get(abs(state))
        if known is None:
            name, low, high = self._diagrams.parts(abs(state))
            known = self._progressed[abs(state)] = self._diagrams.ite(
                self._unfolding(name), self.progressed(high), self.progressed(low)
            )
        return known if state > 0 else -known

    def split(self, function: int) -> dict[int, int]:
        """The states that letters lead to, each with the function of those letters."""
        return self._split(function, {})

    def _split(self, function: int, known: dict[int, dict[int, int]]) -> dict[int, int]:
        if abs(function) == 1:
            return {function: TRUE}
        if function not in known:
            name, low, high = self._diagrams.parts(function)
            if name in self._untils:
                known[function] = {self._reduced(function): TRUE}
            else:
                letter = self._diagrams.variable(name)
                targets: dict[int, int] = {}
                for side, part in ((letter, high), (-letter, low)):
                    for target, letters in self._split(part, known).items():
                        more = self._diagrams.both(side, letters)
                        targets[target] = self._diagrams.either(targets.get(target, FALSE), more)
                known[function] = targets
        return known[function]

    def ends_well(self, state: int) -> bool:
        """Whether a word may end in a state, where no pending until can be fulfilled."""
        while abs(state) != 1:
            _, state, _ = self._diagrams.parts(state)
        return state == TRUE

    def signs(self, function: int) -> frozenset[int]:
        """The polarities of unbounded untils in a function and in everything that it leads to.

        1 if an until is demanded, -1 if one is forbidden. Without a demanded one the function is a
        safety property, without a forbidden one a co-safety property.
        """
        signs: set[int] = set()
        waiting = [(function, 1)]
        seen = set(waiting)
        for each, sign in waiting:
            for name in sorted(self._diagrams.variables(each) & self._untils.keys()):
                yes, no = (self._diagrams.given(each, {name: value}) for value in (True, False))
                own = {sign} if self._diagrams.either(-no, yes) == TRUE else {sign, -sign}
                if self._diagrams.either(-yes, no) == TRUE:
                    own = {-sign}
                if self._untils[name].span.high is None:
                    signs |= own
                more = {(self._unfolding(name), own_sign) for own_sign in own} - seen
                seen |= more
                waiting += sorted(more)
        return frozenset(signs)

    def _until(self, left: int | None, right: int, span: Range) -> int:
        diagrams = self._diagrams
        left, (low, high) = TRUE if left is None else left, span
        if high is not None and high < low:
            return FALSE
        if high is not None and 0 < low < high and left == TRUE:
            # Split into single instants, so that overlapping ranges share their obligations.
            needs = FALSE
            for distance in range(low, high + 1):
                needs = diagrams.either(needs, self._until(left, right, Range(distance, distance)))
            return needs
        now = right if low == 0 else FALSE
        if high == 0:
            return now
        rest = Range(max(low - 1, 0), None if high is None else high - 1)
        later = self._variable(_Until(left, right, rest))
        return diagrams.either(now, diagrams.both(left, later))

    def _release(self, left: int | None, right: int, span: Range) -> int:
        return -self._until(None if left is None else -left, -right, span)

    def _weak_until(self, left: int, right: int, span: Range) -> int:
        diagrams, (low, high) = self._diagrams, span
        if high is not None:
            lasting = self._release(None, left, Range(0, high))
            return diagrams.either(self._until(left, right, span), lasting)
        neither = diagrams.both(-left, -right)
        whole = -self._until(-right, neither, Range(0, None))
        if low == 0:
            return whole
        first = self._release(None, left, Range(0, low - 1))
        return diagrams.both(first, self._release(None, whole, Range(low, low)))

    def _variable(self, until: _Until) -> int:
        if until not in self._names:
            left, right, (low, high) = until
            # Within a family of untils, shorter ones come first.
            shorter = range(high) if low == 0 and high is not None else ()
            for each in [*(_Until(left, right, Range(0, last)) for last in shorter), until]:
                if each not in self._names:
                    self._declare(each)
        return self._diagrams.variable(self._names[until])

    def _declare(self, until: _Until) -> None:
        name = self._names[until] = f"until {len(self._names)}"
        self._untils[name] = until
        self._diagrams.declare(name)
        if until.span.low == 0:
            family = self._families.setdefault((until.left, until.right), {})
            family[name] = float("inf") if until.span.high is None else until.span.high

    def _unfolding(self, name: str) -> int:
        if name not in self._unfolded:
            self._unfolded[name] = self._until(*self._untils[name])
        return self._unfolded[name]

    def _reduced(self, state: int) -> int:
        """An equivalent state, given that an until of a family implies the longer ones.

        A variable is dropped if, given its next one, it makes no difference.
        """
        known = self._smallest.get(abs(state))
        if known is None:
            name, low, high = self._diagrams.parts(abs(state))
            yes = self._reduced(self._implied(high, name, True))
            no = self._reduced(self._implied(low, name, False))
            if yes == self._implied(no, name, True):
                known = no
            elif no == self._implied(yes, name, False):
                known = yes
            else:
                known = self._diagrams.ite(self._diagrams.variable(name), yes, no)
            self._smallest[abs(state)] = known
        return known if state > 0 else -known

    def _implied(self, state: int, name: str, value: bool) -> int:
        """What remains of a state if an until has this value.

        If it is true, longer ones are, too; if it is false, shorter ones are, too.
        """
        until = self._untils[name]
        family = self._families.get((until.left, until.right), {})
        if until.span.low != 0 or len(family) == 1:
            return state
        reach = family[name]
        decided = {
            other: value
            for other in self._diagrams.variables(state) & family.keys()
            if (family[other] > reach) is value and family[other] != reach
        }
        return self._diagrams.given(state, decided)
