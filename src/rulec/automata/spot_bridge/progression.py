"""Deterministic automata of formulas with bounds, by what is left to do after each letter.

A state says what the rest of the word must do: a Boolean combination of obligations, each an until
or a release with what is left of its range (formula progression, Bacchus and Kabanza 1996). States
that say the same are one. With bounds it matters that a shorter until implies a longer one: of all
the pending `eventually[<= 100 steps] p` only the most urgent one counts.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import spot

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.letters import fresh_name
from rulec.automata.spot_bridge.wording import Wording
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Comparison,
    Constant,
    Formula,
    Same,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.logic.timing import Range, range_of

_NOT, _OR, _AND = UnaryOperator.NOT, BinaryOperator.OR, BinaryOperator.AND
_FALSE, _TRUE = Constant(False), Constant(True)


class _Obligation(NamedTuple):
    """``left until right`` if ``strong``, else ``left release right``, within what is left."""

    strong: bool
    left: Formula
    right: Formula
    span: Range


class Progression:
    """The obligations of a formula without operators of the past, and what each letter leaves.

    ``is_safety``: no word is rejected but by one of its prefixes; ``is_cosafety``: none is accepted
    but by one. Judged by the formula's operators, so that it may be one although neither is true.
    """

    def __init__(self, formula: Formula, wording: Wording) -> None:
        self._propositions = spot.make_twa_graph(wording.dictionary)
        self._names = {one: wording.names[one] for one in atoms_of(formula)}
        self._letters = {
            one: buddy.bdd_ithvar(self._propositions.register_ap(name))
            for one, name in self._names.items()
        }
        self._variables: dict[_Obligation, Any] = {}
        self._taken = {*wording.names.values(), wording.alive or ""}
        self._first = self._now(formula, True)
        self._expansions = {
            buddy.bdd_var(self._variables[one]): self._unfolded(one) for one in self._all()
        }
        self.is_safety = not any(o.strong and o.span.high is None for o in self._variables)
        self.is_cosafety = all(o.strong or o.span.high is not None for o in self._variables)
        self._known = self._implications()
        self._composed: dict[int, tuple[Any, Any]] = {}

    def _all(self) -> Iterator[_Obligation]:
        """All obligations: unfolding one of them may bring up more."""
        done = 0
        while done < len(self._variables):
            pending = list(self._variables)[done:]
            done += len(pending)
            yield from pending

    def _variable(self, one: _Obligation) -> Any:
        if one not in self._variables:
            name = fresh_name(f"obligation {len(self._variables)}", self._taken)
            self._variables[one] = buddy.bdd_ithvar(self._propositions.register_ap(name))
        return self._variables[one]

    def _now(self, formula: Formula, wanted: bool) -> Any:
        """That the formula, or its negation, holds: by this letter and what it leaves to do."""
        match formula:
            case Atom() | Comparison():
                return self._letters[formula] if wanted else -self._letters[formula]
            case Constant(value):
                return buddy.bddtrue if value is wanted else buddy.bddfalse
            case Unary(UnaryOperator.NOT, operand):
                return self._now(operand, not wanted)
            case Binary(BinaryOperator.AND | BinaryOperator.OR as operator, left, right):
                first, second = self._now(left, wanted), self._now(right, wanted)
                return first & second if (operator is _AND) is wanted else first | second
            case Binary(BinaryOperator.IMPLIES, left, right):
                return self._now(Binary(_OR, Unary(_NOT, left), right), wanted)
            case Binary(BinaryOperator.IFF | BinaryOperator.XOR as operator, left, right):
                same = (operator is BinaryOperator.IFF) is wanted
                return (self._now(left, True) & self._now(right, same)) | (
                    self._now(left, False) & self._now(right, not same)
                )
            case Unary() | Binary():
                return self._temporal(formula, range_of(formula), wanted)
            case Same():
                raise ValueError(f"`{formula}` is asked of counted objects, not of a word")

    def _temporal(self, formula: Unary | Binary, span: Range, wanted: bool) -> Any:
        match formula:
            case Unary(UnaryOperator.NEXT | UnaryOperator.EVENTUALLY, operand):
                one = _Obligation(True, _TRUE, operand, span)
            case Unary(UnaryOperator.WEAK_NEXT | UnaryOperator.ALWAYS, operand):
                one = _Obligation(False, _FALSE, operand, span)
            case Unary(UnaryOperator.NEVER, operand):
                one = _Obligation(False, _FALSE, Unary(_NOT, operand), span)
            case Binary(BinaryOperator.UNTIL | BinaryOperator.THEN, left, right):
                one = _Obligation(True, left, right, span)
            case Binary(BinaryOperator.RELEASE, left, right):
                one = _Obligation(False, left, right, span)
            case Binary(BinaryOperator.STRONG_RELEASE, left, right, bound):
                turned = Unary(_NOT, left), Unary(_NOT, right)
                return self._now(Binary(BinaryOperator.WEAK_UNTIL, *turned, bound), not wanted)
            case Binary(BinaryOperator.WEAK_UNTIL, left, right) if span == Range(0, None):
                one = _Obligation(False, right, Binary(_OR, left, right), Range(0, None))
            case Binary(BinaryOperator.WEAK_UNTIL, left, right):
                return self._now(_weak_until(left, right, span), wanted)
            case _:
                raise ValueError("operators of the past have no future")
        if not wanted:
            turned = Unary(_NOT, one.left), Unary(_NOT, one.right)
            one = _Obligation(not one.strong, *turned, span)
        return self._unfolded(one)

    def _unfolded(self, one: _Obligation) -> Any:
        """What an obligation asks of this letter, and what it leaves to the rest of the word."""
        strong, _, right, (low, high) = one
        if high is not None and high < low:
            return buddy.bddfalse if strong else buddy.bddtrue
        ends_here = low == 0 and high == 0
        now = self._now(right, True) if low == 0 else buddy.bddfalse if strong else buddy.bddtrue
        if ends_here:
            return now
        rest = Range(max(low - 1, 0), None if high is None else high - 1)
        later = self._variable(one._replace(span=rest))
        if strong:
            return now | (self._now(one.left, True) & later)
        return now & (self._now(one.left, True) | later)

    def _implications(self) -> Any:
        """What obligations imply of each other: a shorter until a longer one."""
        families: dict[tuple[bool, Formula, Formula], list[tuple[float, Any]]] = {}
        for one, variable in self._variables.items():
            if one.span.low == 0:
                reach = float("inf") if one.span.high is None else one.span.high
                families.setdefault(one[:3], []).append((reach, variable))
        known = buddy.bddtrue
        for (strong, _, _), family in families.items():
            family.sort(key=lambda each: each[0], reverse=not strong)
            for (_, shorter), (_, longer) in pairwise(family):
                known &= -shorter | longer
        return known

    def _replaced(self, state: Any) -> Any:
        """The state with every obligation unfolded."""
        if state == buddy.bddtrue or state == buddy.bddfalse:
            return state
        found = self._composed.get(state.id())
        if found is None:
            high = self._replaced(buddy.bdd_high(state))
            low = self._replaced(buddy.bdd_low(state))
            unfolded = self._expansions[buddy.bdd_var(state)]
            found = state, buddy.bdd_ite(unfolded, high, low)
            # The first keeps its number from being given to another.
            self._composed[state.id()] = found
        return found[1]

    def _split(self, left: Any, known: dict[int, Any]) -> dict[int, tuple[Any, Any]]:
        """By target: (letters, target). Letters' variables are above those of obligations."""
        if left == buddy.bddtrue or left == buddy.bddfalse:
            return {left.id(): (buddy.bddtrue, left)}
        variable = buddy.bdd_var(left)
        if variable in self._expansions:
            return {left.id(): (buddy.bddtrue, left)}
        if left.id() not in known:
            letter = buddy.bdd_ithvar(variable)
            found: dict[int, tuple[Any, Any]] = {}
            for side, branch in (
                (letter, buddy.bdd_high(left)),
                (-letter, buddy.bdd_low(left)),
            ):
                for key, (letters, target) in self._split(branch, known).items():
                    before = found[key][0] if key in found else buddy.bddfalse
                    found[key] = before | (side & letters), target
            known[left.id()] = found
        result: dict[int, tuple[Any, Any]] = known[left.id()]
        return result

    def _table(self) -> tuple[list[Any], list[list[tuple[Any, int]]]]:
        """What is left to do in each state, and the edges from it: letters, target.

        State 0 is the one before the word; nothing leads back to it.
        """
        states: list[Any] = [None]
        numbers: dict[int, int] = {}
        table = []
        for state in states:
            left = self._first if state is None else self._replaced(state)
            # What the implications make the same becomes the same.
            left = buddy.bdd_constrain(left, self._known)
            edges = []
            for letters, target in self._split(left, {}).values():
                if target.id() not in numbers:
                    numbers[target.id()] = len(states)
                    states.append(target)
                edges.append((letters, numbers[target.id()]))
            table.append(edges)
        return states, table

    def infinite(self) -> Any:
        """The deterministic, complete, weak Büchi automaton of the formula on infinite words.

        The formula must be a safety or a co-safety one.
        """
        states, table = self._table()
        automaton = self._empty(len(states))
        for number, (state, edges) in enumerate(zip(states, table, strict=True)):
            # Buddy can't compare with None.
            marked = state is not None and (
                state != buddy.bddfalse if self.is_safety else state == buddy.bddtrue
            )
            for letters, target in edges:
                automaton.new_edge(number, target, letters, _MARKED if marked else _PLAIN)
        return automaton

    def finite(self, alive: str) -> Any:
        """The same for finite words, of any formula: infinite ones on which ``alive`` comes to end.

        What comes after a word's end does not matter, but ``alive`` does not come back.
        """
        states, table = self._table()
        lost, ended = len(states), len(states) + 1
        automaton = self._empty(len(states) + 2)
        going = buddy.bdd_ithvar(automaton.register_ap(alive))
        for number, (state, edges) in enumerate(zip(states, table, strict=True)):
            for letters, target in edges:
                automaton.new_edge(number, target, letters & going, _PLAIN)
            # Before the first letter there is no word yet.
            well = state is not None and self._ends_well(state)
            automaton.new_edge(number, ended if well else lost, -going, _PLAIN)
        automaton.new_edge(lost, lost, buddy.bddtrue, _PLAIN)
        automaton.new_edge(ended, ended, -going, _MARKED)
        automaton.new_edge(ended, lost, going, _MARKED)
        return automaton

    def _ends_well(self, state: Any) -> bool:
        """Where nothing comes any more, no until is fulfilled and no release is broken."""
        for one, variable in self._variables.items():
            state = buddy.bdd_restrict(state, -variable if one.strong else variable)
        return bool(state == buddy.bddtrue)

    def _empty(self, n_states: int) -> Any:
        automaton = spot.make_twa_graph(self._propositions.get_dict())
        for name in self._names.values():
            automaton.register_ap(name)
        automaton.set_buchi()
        automaton.new_states(n_states)
        automaton.set_init_state(0)
        automaton.prop_universal(True)
        automaton.prop_weak(True)
        automaton.prop_state_acc(True)
        return automaton


_PLAIN, _MARKED = spot.mark_t([]), spot.mark_t([0])


def _weak_until(left: Formula, right: Formula, span: Range) -> Formula:
    """The same by other operators, and by the unbounded ``weak until``."""
    low, high = span
    if high is not None:
        bound = Bound(Fraction(low), Fraction(high), "steps")
        lasting = Unary(UnaryOperator.ALWAYS, left, Bound(Fraction(0), Fraction(high), "steps"))
        return Binary(_OR, Binary(BinaryOperator.UNTIL, left, right, bound), lasting)
    first = Bound(Fraction(0), Fraction(low - 1), "steps")
    then = Bound(Fraction(low), Fraction(low), "steps")
    weak = Binary(BinaryOperator.WEAK_UNTIL, left, right)
    return Binary(
        _AND,
        Unary(UnaryOperator.ALWAYS, left, first),
        Unary(UnaryOperator.WEAK_NEXT, weak, then),
    )
