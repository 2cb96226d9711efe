"""From a rule's formula to its deterministic automaton, without Spot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import and_

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
from rulec.automata.decision_diagrams.formula_automata import FormulaAutomata
from rulec.automata.decision_diagrams.symbolic_automaton import (
    SymbolicAutomaton,
    joined,
    with_registers,
)
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.tables import DeterministicAutomaton, TableEdge
from rulec.logic import formula as ltl
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
