"""A shortest trace that one rule forbids and others allow.

A rule forbids a trace if it is violated for some objects. If it is, it is by the trace of these
objects alone, on the stretch on which they are there together; so traces of just the objects that a
rule speaks of tell whether another rule forbids all that it does. The other rule is asked about
these objects in all ways in which they fit its variables.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rulec.analysis.diff.shared_vocabulary import shared_vocabulary
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import NumberRead
from rulec.logic.free_names import names_in
from rulec.monitoring.verify import verify
from rulec.rulebook.model import Axiom
from rulec.trace import Trace
from rulec.witnesses.joint_alphabet import JointAlphabet
from rulec.witnesses.letter_functions import monitor_function
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.shortest_word import shortest_word
from rulec.witnesses.trace_synthesis import single_rule_rulebook, synthesize_trace
from rulec.witnesses.undecided import UndecidedError


def counterexample(
    side: AnalyzedRule, others: Sequence[AnalyzedRule], given: Sequence[Axiom] = ()
) -> Trace | None:
    """A shortest trace that a rule forbids and all others allow; None if there is none.

    ``given`` is to hold in its states, besides what is known of any. Raises UndecidedError.
    """
    scene = _scene(side, others, given)
    own = {variable.name: variable.name for variable in side.rule.variables}
    machines, wanted = [side.rule.machine], [False]
    columns = [monitor_function(side.rule.machine, own, scene)]
    for analyzed_rule in others:
        for binding in scene.bindings(analyzed_rule.rule.variables):
            machines.append(analyzed_rule.rule.machine)
            columns.append(monitor_function(analyzed_rule.rule.machine, binding, scene))
            wanted.append(True)
    alphabet = JointAlphabet(scene, columns)
    word = shortest_word(machines, wanted, alphabet.symbols)
    if word is None:
        return None
    forbidding = single_rule_rulebook(side.rulebook, side.rule, scene)
    allowing = [
        single_rule_rulebook(analyzed_rule.rulebook, analyzed_rule.rule, scene)
        for analyzed_rule in others
    ]

    def shows(trace: Trace) -> bool:
        forbids = bool(verify(trace, forbidding).violations)
        return forbids and not any(
            verify(trace, compiled_rulebook).violations for compiled_rulebook in allowing
        )

    situations = [alphabet.situations[symbol] for symbol in word]
    steps = [
        analyzed_rule.rule.step_s
        for analyzed_rule in (side, *others)
        if analyzed_rule.rule.step_s is not None
    ]
    return synthesize_trace(situations, scene, (*steps, Fraction(1))[0], shows)


def _scene(
    side: AnalyzedRule, others: Sequence[AnalyzedRule], given: Sequence[Axiom]
) -> ObjectUniverse:
    """The objects that a rule speaks of, in the words of all the rulebooks."""
    sides = (side, *others)
    read = {name for side in sides for name in declarations_read(side.rule)}
    axioms = tuple(dict.fromkeys((*(fact for side in sides for fact in side.axioms), *given)))
    asked = read | {name for fact in axioms for name in names_in(fact.formula)}
    vocabulary, unsaid = side.rulebook.vocabulary, frozenset[str]()
    for analyzed_rule in others:
        if analyzed_rule.rulebook.vocabulary == vocabulary:
            continue
        words = shared_vocabulary(vocabulary, analyzed_rule.rulebook.vocabulary)
        for name in sorted(words.unlike & asked):
            raise UndecidedError(f"`{name}` is not declared alike in both")
        vocabulary, unsaid = words.vocabulary, unsaid | words.not_shared | words.unlike
    objects = {variable.name: variable.type for variable in side.rule.variables}
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
