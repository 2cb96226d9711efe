"""From a rule's formula to its deterministic automaton, without Spot."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from operator import and_, eq, ne, or_

from rulec.automata.alphabet import (
    count_letters,
    fresh_name,
    knowledge,
    letters_with,
    names_of,
    propositions_of,
)
from rulec.automata.compiler_jobs import BeyondReachError
from rulec.automata.decision_diagrams.diagrams import FALSE, TRUE, Diagrams
from rulec.automata.decision_diagrams.pending_untils import PendingUntils
from rulec.automata.decision_diagrams.symbolic_automaton import (
    SymbolicAutomaton,
    explored,
    joined,
    negated,
    with_registers,
)
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.tables import DeterministicAutomaton, TableEdge
from rulec.logic import formula as ltl
from rulec.logic.bounds import Range, range_of
from rulec.logic.past_registers import eliminate_past
from rulec.logic.semantics import Semantics


@dataclass(frozen=True, slots=True)
class RuleAutomaton:
    """A formula's automaton over the letters of its ``diagrams``.

    ``names`` maps its propositions to names; ``possible`` is the function of the letters that facts
    allow. ``alive`` is the name of the proposition that is true while a finite word lasts, None if
    words are infinite.
    """

    automaton: SymbolicAutomaton
    diagrams: Diagrams
    names: dict[ltl.Proposition, str]
    possible: int
    alive: str | None


def contradicts(known: ltl.Formula) -> bool:
    """Whether a formula without temporal operators holds in no state."""
    diagrams = Diagrams()
    diagrams.declare_letters(names_of(propositions_of(known)))
    return diagrams.of_state(known) == FALSE


def automaton_of(
    formula: ltl.Formula,
    reads: Sequence[Read | NumberRead],
    semantics: Semantics,
    facts: Sequence[ltl.Formula],
) -> RuleAutomaton:
    """The automaton of ``formula``, with bounds in steps, over its possible letters.

    Its language is the formula's, with ``knowledge(reads)`` and all ``facts`` true at every
    instant; the facts may contain other propositions, too. Raises BeyondReachError.
    """
    past = eliminate_past(formula)
    if past.memories:
        raise BeyondReachError
    propositions = propositions_of(formula)
    fresh = [register.atom for register in past.registers]
    names = names_of([*propositions, *fresh])
    diagrams = Diagrams()
    diagrams.declare_letters(names)
    possible = TRUE
    for fact in facts:
        others = [atom for atom in propositions_of(fact) if atom not in names]
        hidden = {atom: f"hidden {place}" for place, atom in enumerate(others)}
        own = Diagrams()
        own.declare_letters({**{atom: names[atom] for atom in propositions}, **hidden})
        left = own.for_some(own.of_state(fact), hidden.values())
        possible = diagrams.both(possible, own.copied(left, diagrams))
    known = diagrams.both(possible, diagrams.of_state(knowledge(reads, propositions)))
    ends = semantics == "finite"
    automaton = FormulaAutomata(diagrams, ends=ends).of(past.present)
    if known != TRUE or ends:
        automaton = joined(automaton, _always(known, ends=ends), and_, diagrams)
    if past.registers:
        automaton = with_registers(automaton, past.registers, diagrams)
    return RuleAutomaton(
        automaton,
        diagrams,
        {atom: names[atom] for atom in propositions},
        possible,
        fresh_name("alive", set(names.values())) if ends else None,
    )


def _always(letters: int, *, ends: bool) -> SymbolicAutomaton:
    """The automaton of words with these letters only; a finite word has at least one letter."""
    if ends:
        rows = [{(1, 0): letters, (2, 0): -letters}] * 2
        return SymbolicAutomaton((*rows, {(2, 0): TRUE}), (False, True, False))
    return SymbolicAutomaton(({(0, 1): letters, (1, 0): -letters}, {(1, 0): TRUE}))


def over_letters(
    source: RuleAutomaton, reads: Sequence[Read | NumberRead]
) -> tuple[DeterministicAutomaton, int]:
    """The automaton over bit sets of the letters of ``reads``, and the set of possible letters."""
    sets = {
        source.names[atom]: letters for atom, letters in letters_with(reads, source.names).items()
    }
    everything = (1 << count_letters(reads)) - 1
    bits: dict[int, int] = {TRUE: everything}
    automaton = source.automaton
    rows = [
        tuple(
            [
                TableEdge(letters, target, marks)
                for (target, marks), function in row.items()
                if (letters := source.diagrams.bits(function, sets, bits))
            ]
        )
        for row in automaton.edges
    ]
    possible = source.diagrams.bits(source.possible, sets, bits)
    if automaton.ends_well is None:
        return DeterministicAutomaton(tuple(rows), 0, automaton.accepts), possible
    # After its end, a word stays in one of two additional states.
    size = len(rows)
    rows += [(TableEdge(everything, size + well, 0),) for well in (False, True)]
    after = [*automaton.ends_well, False, True]
    return (
        DeterministicAutomaton(
            tuple(rows), 0, bool, tuple([(size + well, int(well)) for well in after])
        ),
        possible,
    )


_NOT, _AND, _OR = ltl.UnaryOperator.NOT, ltl.BinaryOperator.AND, ltl.BinaryOperator.OR
_ALWAYS, _NEVER = ltl.UnaryOperator.ALWAYS, ltl.UnaryOperator.NEVER
_EVENTUALLY = ltl.UnaryOperator.EVENTUALLY
_CONNECTIVES = {
    _AND: and_,
    _OR: or_,
    ltl.BinaryOperator.IMPLIES: lambda left, right: right or not left,
    ltl.BinaryOperator.IFF: eq,
    ltl.BinaryOperator.XOR: ne,
}


class FormulaAutomata:
    """Automata of past-free formulas over the letters of diagrams; ``ends`` if words are finite."""

    def __init__(self, diagrams: Diagrams, *, ends: bool) -> None:
        self._diagrams = diagrams
        self._untils = PendingUntils(diagrams)
        self._ends = ends
        self._known: dict[ltl.Formula, SymbolicAutomaton] = {}

    def of(self, formula: ltl.Formula) -> SymbolicAutomaton:
        """The automaton of a formula. Raises BeyondReachError."""
        if formula not in self._known:
            self._known[formula] = self._of(formula)
        return self._known[formula]

    def _of(self, formula: ltl.Formula) -> SymbolicAutomaton:
        match formula:
            case ltl.Unary(operator, operand) if operator is _NOT:
                return negated(self.of(operand))
            case ltl.Binary(operator, left, right) if operator in _CONNECTIVES:
                parts = self.of(left), self.of(right)
                return joined(*parts, _CONNECTIVES[operator], self._diagrams)
        function = self._untils.function_of(formula)
        signs = self._untils.signs(function)
        if self._ends or len(signs) < 2:
            return self._progression(function, is_safety=1 not in signs)
        return self._recurring(formula)

    def _progression(self, function: int, *, is_safety: bool) -> SymbolicAutomaton:
        untils = self._untils

        def step(state: int | None) -> Iterable[tuple[int, int, int]]:
            demand = function if state is None else untils.progressed(state)
            for target, letters in untils.split(demand).items():
                kept = target != FALSE if is_safety else target == TRUE
                yield target, int(kept and not self._ends), letters

        first: int | None = None
        states, rows = explored(first, step)
        if not self._ends:
            return SymbolicAutomaton(tuple(rows))
        # The empty word does not exist.
        ends_well = [state is not None and untils.ends_well(state) for state in states]
        return SymbolicAutomaton(tuple(rows), tuple(ends_well))

    def _recurring(self, formula: ltl.Formula) -> SymbolicAutomaton:
        """The automaton of an always, never or eventually whose operand is decided by prefixes."""
        match formula:
            case ltl.Unary(operator, operand) if range_of(formula) == Range(0, None):
                if operator is _NEVER:
                    return self.of(ltl.Unary(_ALWAYS, ltl.Unary(_NOT, operand)))
                if operator is _EVENTUALLY:
                    return negated(self.of(ltl.Unary(_ALWAYS, ltl.Unary(_NOT, operand))))
                if operator is _ALWAYS:
                    return self._always(operand)
        raise BeyondReachError

    def _always(self, operand: ltl.Formula) -> SymbolicAutomaton:
        for operator, polarity in ((_AND, True), (_OR, False)):
            match _without_negations(operand, polarity):
                case ltl.Binary(connective, left, right) if connective is operator:
                    sides = [part if polarity else ltl.Unary(_NOT, part) for part in (left, right)]
                    first, second = [self.of(ltl.Unary(_ALWAYS, side)) for side in sides]
                    return joined(first, second, and_, self._diagrams)
        untils = self._untils
        function = untils.function_of(operand)
        if -1 in untils.signs(function):
            raise BeyondReachError
        diagrams = self._diagrams

        def step(state: tuple[int, int]) -> Iterable[tuple[tuple[int, int], int, int]]:
            # The obligations from before the last breakpoint, and those since then.
            earlier = untils.split(untils.progressed(state[0]))
            since = untils.split(diagrams.both(untils.progressed(state[1]), function))
            edges: dict[tuple[tuple[int, int], int], int] = {}
            for first, letters in earlier.items():
                for second, more in since.items():
                    met = diagrams.both(letters, more)
                    if met == FALSE:
                        continue
                    if FALSE in (first, second):
                        key = (FALSE, FALSE), 0
                    elif first == TRUE:
                        key = (second, TRUE), 1
                    else:
                        key = (first, second), 0
                    edges[key] = diagrams.either(edges.get(key, FALSE), met)
            return [(target, marks, letters) for (target, marks), letters in edges.items()]

        _, rows = explored((TRUE, TRUE), step)
        return SymbolicAutomaton(tuple(rows), is_weak=False)


def _without_negations(formula: ltl.Formula, polarity: bool) -> ltl.Formula:
    """Strip negations: the formula if ``polarity`` comes out true, else the constant true."""
    while isinstance(formula, ltl.Unary) and formula.operator is _NOT:
        formula, polarity = formula.operand, not polarity
    return formula if polarity else ltl.Constant(True)
