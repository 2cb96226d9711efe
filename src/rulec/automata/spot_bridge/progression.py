"""Deterministic automata of bounded formulas, by formula progression.

A state represents what the rest of the word must satisfy (formula progression, Bacchus and Kabanza,
"Using temporal logic to control search in a forward chaining planner", 1996). Equivalent states are
merged. With bounds it matters that a shorter until implies a longer one: of all the pending
`eventually[<= 100 steps] p` only the most urgent one counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

import spot

from rulec.logic import formula as ltl

import buddy  # isort: skip - only once spot has been imported
from rulec.automata.alphabet import fresh_name
from rulec.automata.spot_bridge.spot_formulas import SpotFormulas
from rulec.automata.tables import MOST_EDGES, MOST_STATES, SizeError
from rulec.logic.bounds import Range, range_of
from rulec.logic.fold import Algebra, fold
from rulec.logic.formula import Formula


class Progression:
    """The automaton of a formula without past operators.

    ``is_decided``: on infinite words, too, a prefix decides every rejected word, or every accepted
    one: the formula is a safety or co-safety formula, judged by its operators.
    """

    def __init__(self, formula: Formula, spot_formulas: SpotFormulas) -> None:
        self._of = Obligations(formula, spot_formulas)
        self.is_decided = self._of.is_safety or self._of.is_cosafety
        self._composed: dict[int, tuple[Any, Any]] = {}

    def _replaced(self, state: Any) -> Any:
        if state == buddy.bddtrue or state == buddy.bddfalse:
            return state
        result = self._composed.get(state.id())
        if result is None:
            high = self._replaced(buddy.bdd_high(state))
            low = self._replaced(buddy.bdd_low(state))
            unfolded = self._of.unfolded[buddy.bdd_var(state)]
            result = state, buddy.bdd_ite(unfolded, high, low)
            # Holding the first BDD keeps its number from being reused.
            self._composed[state.id()] = result
        return result[1]

    def _split(self, left: Any, known: dict[int, Any]) -> dict[int, tuple[Any, Any]]:
        """For each target: (letters, target). Letters' variables are above those of obligations."""
        if left == buddy.bddtrue or left == buddy.bddfalse:
            return {left.id(): (buddy.bddtrue, left)}
        variable = buddy.bdd_var(left)
        if variable in self._of.unfolded:
            return {left.id(): (buddy.bddtrue, left)}
        if left.id() not in known:
            letter = buddy.bdd_ithvar(variable)
            results: dict[int, tuple[Any, Any]] = {}
            for side, branch in ((letter, buddy.bdd_high(left)), (-letter, buddy.bdd_low(left))):
                for key, (letters, target) in self._split(branch, known).items():
                    before = results[key][0] if key in results else buddy.bddfalse
                    results[key] = before | (side & letters), target
            known[left.id()] = results
        result: dict[int, tuple[Any, Any]] = known[left.id()]
        return result

    def _table(self) -> tuple[list[Any], list[list[tuple[Any, int]]]]:
        """The obligations of each state, and its edges as (letters, target).

        State 0 is the one before the word; nothing leads back to it. Raises SizeError.
        """
        states: list[Any] = [None]
        n_edges = 0
        numbers: dict[int, int] = {}
        table = []
        for state in states:
            left = self._of.first if state is None else self._replaced(state)
            # Under the known implications, equivalent states become equal.
            left = buddy.bdd_constrain(left, self._of.known)
            edges = []
            for letters, target in self._split(left, {}).values():
                if target.id() not in numbers:
                    numbers[target.id()] = len(states)
                    states.append(target)
                edges.append((letters, numbers[target.id()]))
            table.append(edges)
            n_edges += len(edges)
            if len(states) > MOST_STATES or n_edges > MOST_EDGES:
                raise SizeError
        return states, table

    def infinite(self) -> Any:
        """The deterministic, complete, weak Büchi automaton of a decided formula."""
        states, table = self._table()
        automaton = self._empty(len(states))
        for number, (state, edges) in enumerate(zip(states, table, strict=True)):
            # Buddy cannot compare a BDD with None.
            marked = state is not None and (
                state != buddy.bddfalse if self._of.is_safety else state == buddy.bddtrue
            )
            for letters, target in edges:
                automaton.new_edge(number, target, letters, _MARKED if marked else _PLAIN)
        return automaton

    def finite(self, alive: str) -> Any:
        """The automaton of a formula on finite words: infinite words where ``alive`` becomes false.

        What comes after a word's end does not matter, except that ``alive`` stays false.
        """
        states, table = self._table()
        lost, ended = len(states), len(states) + 1
        automaton = self._empty(len(states) + 2)
        going = buddy.bdd_ithvar(automaton.register_ap(alive))
        for number, (state, edges) in enumerate(zip(states, table, strict=True)):
            for letters, target in edges:
                automaton.new_edge(number, target, letters & going, _PLAIN)
            # Before the first letter there is no word yet.
            well = state is not None and self._of.ends_well(state)
            automaton.new_edge(number, ended if well else lost, -going, _PLAIN)
        automaton.new_edge(lost, lost, buddy.bddtrue, _PLAIN)
        automaton.new_edge(ended, ended, -going, _MARKED)
        automaton.new_edge(ended, lost, going, _MARKED)
        return automaton

    def _empty(self, n_states: int) -> Any:
        automaton = spot.make_twa_graph(self._of.propositions.get_dict())
        for name in self._of.names.values():
            automaton.register_ap(name)
        automaton.set_buchi()
        automaton.new_states(n_states)
        automaton.set_init_state(0)
        automaton.prop_universal(True)
        automaton.prop_weak(True)
        automaton.prop_state_acc(True)
        return automaton


_PLAIN, _MARKED = spot.mark_t([]), spot.mark_t([0])


_NOT, _OR, _AND = ltl.UnaryOperator.NOT, ltl.BinaryOperator.OR, ltl.BinaryOperator.AND
_FALSE, _TRUE = ltl.Constant(False), ltl.Constant(True)


class _Obligation(NamedTuple):
    """A pending until (``strong``) or release, with the rest of its range."""

    strong: bool
    left: ltl.Formula
    right: ltl.Formula
    span: Range


_Signed: TypeAlias = Callable[[bool], Any]
"""Maps True to a formula's BDD and False to its negation's; negation is pushed down to obligations,
so that no BDD contains a negated obligation.
"""


def _joined(both: bool, left: _Signed, right: _Signed) -> _Signed:
    """A conjunction (``both``) or disjunction, negated by De Morgan's laws."""

    def signed(polarity: bool) -> Any:
        first, second = left(polarity), right(polarity)
        return first & second if both is polarity else first | second

    return signed


def _equivalence(left: _Signed, right: _Signed) -> _Signed:
    return lambda polarity: (left(True) & right(polarity)) | (left(False) & right(not polarity))


class Obligations:
    """The obligations of a formula without past operators, as variables of BDDs.

    ``propositions`` is a graph without states that has a variable for each: those of letters, by
    their ``names``, come before those of obligations. ``first`` is what the formula demands of a
    letter and of the rest of the word, ``unfolded`` what each obligation demands, by its variable,
    and ``known`` the implications between obligations. ``is_safety``: every rejected word has a
    prefix that decides this; ``is_cosafety``: every accepted word has one. Both are judged by the
    formula's operators, so each may be false although the property holds.
    """

    def __init__(self, formula: ltl.Formula, spot_formulas: SpotFormulas) -> None:
        self.propositions = spot.make_twa_graph(spot_formulas.dictionary)
        self.names = {atom: spot_formulas.names[atom] for atom in ltl.atoms_of(formula)}
        self._letters = {
            atom: buddy.bdd_ithvar(self.propositions.register_ap(name))
            for atom, name in self.names.items()
        }
        self._variables: dict[_Obligation, Any] = {}
        self._taken = {*spot_formulas.names.values(), spot_formulas.alive or ""}
        self.first = self._now(formula, True)
        self.unfolded = {
            buddy.bdd_var(self._variables[obligation]): self._unfolded(obligation)
            for obligation in self._all()
        }
        self.is_safety = not any(o.strong and o.span.high is None for o in self._variables)
        self.is_cosafety = all(o.strong or o.span.high is not None for o in self._variables)
        self.known = self._implications()
        self._at_end = buddy.bddtrue
        for obligation, variable in reversed(self._variables.items()):
            self._at_end &= -variable if obligation.strong else variable

    def _all(self) -> Iterator[_Obligation]:
        """All obligations; unfolding one of them may add more."""
        done = 0
        while done < len(self._variables):
            pending = list(self._variables)[done:]
            done += len(pending)
            yield from pending

    def _variable(self, _obligation: _Obligation) -> Any:
        if _obligation not in self._variables:
            name = fresh_name(f"obligation {len(self._variables)}", self._taken)
            self._variables[_obligation] = buddy.bdd_ithvar(self.propositions.register_ap(name))
        return self._variables[_obligation]

    def _now(self, formula: ltl.Formula, polarity: bool) -> Any:
        # Not cached: that would be a reference cycle, and BDDs would outlive their use.
        algebra: Algebra[_Signed] = Algebra(
            proposition=self._proposition,
            constant=lambda value: (
                lambda polarity: buddy.bddtrue if value is polarity else buddy.bddfalse
            ),
            negation=lambda operand: lambda polarity: operand(not polarity),
            conjunction=partial(_joined, True),
            disjunction=partial(_joined, False),
            equivalence=_equivalence,
            operation=self._operation,
        )
        return fold(formula, algebra)(polarity)

    def _proposition(self, proposition: ltl.Proposition) -> _Signed:
        letters = self._letters[proposition]
        return lambda polarity: letters if polarity else -letters

    def _operation(
        self, formula: ltl.Unary | ltl.Binary, _: Callable[[ltl.Formula], _Signed]
    ) -> _Signed:
        span = range_of(formula)
        return lambda polarity: self._temporal(formula, span, polarity)

    def _temporal(self, formula: ltl.Unary | ltl.Binary, span: Range, polarity: bool) -> Any:
        match formula:
            case ltl.Unary(ltl.UnaryOperator.NEXT | ltl.UnaryOperator.EVENTUALLY, operand):
                obligation = _Obligation(True, _TRUE, operand, span)
            case ltl.Unary(ltl.UnaryOperator.WEAK_NEXT | ltl.UnaryOperator.ALWAYS, operand):
                obligation = _Obligation(False, _FALSE, operand, span)
            case ltl.Unary(ltl.UnaryOperator.NEVER, operand):
                obligation = _Obligation(False, _FALSE, ltl.Unary(_NOT, operand), span)
            case ltl.Binary(ltl.BinaryOperator.UNTIL | ltl.BinaryOperator.THEN, left, right):
                obligation = _Obligation(True, left, right, span)
            case ltl.Binary(ltl.BinaryOperator.RELEASE, left, right):
                obligation = _Obligation(False, left, right, span)
            case ltl.Binary(ltl.BinaryOperator.STRONG_RELEASE, left, right, bound):
                turned = ltl.Unary(_NOT, left), ltl.Unary(_NOT, right)
                return self._now(
                    ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, *turned, bound), not polarity
                )
            case ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, left, right) if span == Range(0, None):
                obligation = _Obligation(False, right, ltl.Binary(_OR, left, right), Range(0, None))
            case ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, left, right):
                return self._now(_weak_until(left, right, span), polarity)
            case _:
                raise ValueError("operators of the past have no future")
        if not polarity:
            turned = ltl.Unary(_NOT, obligation.left), ltl.Unary(_NOT, obligation.right)
            obligation = _Obligation(not obligation.strong, *turned, span)
        return self._unfolded(obligation)

    def _unfolded(self, _obligation: _Obligation) -> Any:
        strong, left, right, (low, high) = _obligation
        if high is not None and high < low:
            return buddy.bddfalse if strong else buddy.bddtrue
        if high is not None and 0 < low < high and left == (_TRUE if strong else _FALSE):
            # Split into single instants, so that overlapping ranges share their obligations.
            demand = buddy.bddfalse if strong else buddy.bddtrue
            for distance in range(low, high + 1):
                there = self._unfolded(_obligation._replace(span=Range(distance, distance)))
                demand = demand | there if strong else demand & there
            return demand
        now = self._now(right, True) if low == 0 else buddy.bddfalse if strong else buddy.bddtrue
        if low == 0 and high == 0:
            return now
        rest = Range(max(low - 1, 0), None if high is None else high - 1)
        later = self._variable(_obligation._replace(span=rest))
        if strong:
            return now | (self._now(left, True) & later)
        return now & (self._now(left, True) | later)

    def _implications(self) -> Any:
        """The implications between obligations: a shorter until implies a longer one."""
        families: dict[tuple[bool, ltl.Formula, ltl.Formula], list[tuple[float, Any]]] = {}
        for obligation, variable in self._variables.items():
            if obligation.span.low == 0:
                reach = float("inf") if obligation.span.high is None else obligation.span.high
                families.setdefault(obligation[:3], []).append((reach, variable))
        known = buddy.bddtrue
        for (strong, _, _), family in families.items():
            family.sort(key=lambda each: each[0], reverse=not strong)
            for (_, shorter), (_, longer) in pairwise(family):
                known &= -shorter | longer
        return known

    def ends_well(self, state: Any) -> bool:
        """Whether a word may end in a state, with its pending untils unfulfilled."""
        return bool(buddy.bdd_restrict(state, self._at_end) == buddy.bddtrue)


def _weak_until(left: ltl.Formula, right: ltl.Formula, span: Range) -> ltl.Formula:
    """A bounded ``weak until``, expressed by other operators and the unbounded one."""

    def steps(first: int, last: int) -> ltl.Bound:
        return ltl.Bound(Fraction(first), Fraction(last), "steps")

    low, high = span
    if high is not None:
        lasting = ltl.Unary(ltl.UnaryOperator.ALWAYS, left, steps(0, high))
        until = ltl.Binary(ltl.BinaryOperator.UNTIL, left, right, steps(low, high))
        return ltl.Binary(_OR, until, lasting)
    first = ltl.Unary(ltl.UnaryOperator.ALWAYS, left, steps(0, low - 1))
    weak = ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, left, right)
    return ltl.Binary(_AND, first, ltl.Unary(ltl.UnaryOperator.WEAK_NEXT, weak, steps(low, low)))
