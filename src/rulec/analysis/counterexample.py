"""A shortest trace that one rule forbids and others allow.

A rule forbids a trace if it is violated for some objects. If it is, it is by the trace of these
objects alone, on the stretch on which they are there together; so traces of just the objects that a
rule speaks of tell whether another rule forbids all that it does. The other rule is asked about
these objects in all ways in which they fit its variables.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.analysis.shared_vocabulary import shared_vocabulary
from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import NumberRead
from rulec.logic.free_names import names_in
from rulec.monitoring.verify import verify
from rulec.rulebook.rulebook_model import Axiom
from rulec.trace import Trace
from rulec.witnesses.joint_alphabet import JointAlphabet
from rulec.witnesses.letter_functions import monitor_function
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.shortest_word import shortest_word
from rulec.witnesses.trace_synthesis import single_rule_rulebook, synthesize_trace
from rulec.witnesses.undecided import UndecidedError


def counterexample(
    forbidding: AnalyzedRule, allowing: Sequence[AnalyzedRule], given: Sequence[Axiom] = ()
) -> Trace | None:
    """A shortest trace that only this rule forbids, or None.

    ``given`` is to hold in its states, besides what is known of any. Raises UndecidedError.
    """
    universe = _universe(forbidding, allowing, given)
    own = {variable.name: variable.name for variable in forbidding.rule.variables}
    monitors, verdicts = [forbidding.rule.machine], [False]
    functions = [monitor_function(forbidding.rule.machine, own, universe)]
    for allowed in allowing:
        for binding in universe.bindings(allowed.rule.variables):
            monitors.append(allowed.rule.machine)
            functions.append(monitor_function(allowed.rule.machine, binding, universe))
            verdicts.append(True)
    alphabet = JointAlphabet(universe, functions)
    word = shortest_word(monitors, verdicts, alphabet.letters)
    if word is None:
        return None
    forbidding_book = single_rule_rulebook(forbidding.rulebook, forbidding.rule, universe)
    allowing_books = [
        single_rule_rulebook(allowed.rulebook, allowed.rule, universe) for allowed in allowing
    ]

    def shows(trace: Trace) -> bool:
        forbids = bool(verify(trace, forbidding_book).violations)
        return forbids and not any(verify(trace, book).violations for book in allowing_books)

    states = [alphabet.states[letter] for letter in word]
    steps = [rule.rule.step_s for rule in (forbidding, *allowing) if rule.rule.step_s is not None]
    return synthesize_trace(states, universe, (*steps, Fraction(1))[0], shows)


def _universe(
    forbidding: AnalyzedRule, allowing: Sequence[AnalyzedRule], given: Sequence[Axiom]
) -> ObjectUniverse:
    """The objects of a rule, in the vocabulary of all the rulebooks."""
    analyzed_rules = (forbidding, *allowing)
    read = {name for analyzed in analyzed_rules for name in declarations_read(analyzed.rule)}
    axioms = tuple(
        dict.fromkeys(
            (*(axiom for analyzed in analyzed_rules for axiom in analyzed.axioms), *given)
        )
    )
    names = read | {name for axiom in axioms for name in names_in(axiom.formula)}
    vocabulary, unsaid = forbidding.rulebook.vocabulary, frozenset[str]()
    for allowed in allowing:
        if allowed.rulebook.vocabulary == vocabulary:
            continue
        words = shared_vocabulary(vocabulary, allowed.rulebook.vocabulary)
        for name in sorted(words.unlike & names):
            raise UndecidedError(f"`{name}` is not declared alike in both")
        vocabulary, unsaid = words.vocabulary, unsaid | words.not_shared | words.unlike
    objects = {variable.name: variable.type for variable in forbidding.rule.variables}
    return ObjectUniverse(objects, vocabulary, axioms, unsaid - read)


def declarations_read(rule: CompiledRule) -> frozenset[str]:
    """The declarations that a rule reads."""
    names: set[str] = set()
    for read in rule.machine.reads:
        if isinstance(read, NumberRead):
            names.update(name for _, term in read.terms for name in names_in(term))
        else:
            names.add(read.name)
    return frozenset(names)
