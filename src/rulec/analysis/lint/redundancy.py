"""What a rule adds to others: can it be violated, can it be kept, do others imply it?"""

from __future__ import annotations

from collections.abc import Sequence
from math import prod

from rulec.analysis.counterexample import counterexample
from rulec.analysis.lint.conflict_search import are_related
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.witnesses.joint_alphabet import JointAlphabet
from rulec.witnesses.letter_functions import monitor_function
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.shortest_word import shortest_word

MOST_PREMISES = 6
MOST_JOINT_STATES = 5_000
"""Others are taken together as long as their automata have no more states than these."""


def can_be_violated(side: AnalyzedRule) -> bool:
    """Is there a trace that violates the rule? Raises UndecidedError."""
    return counterexample(side, []) is not None


def can_be_kept(side: AnalyzedRule) -> bool:
    """Is there a trace, with objects for the rule to speak of, that keeps it?

    Raises UndecidedError.
    """
    objects = {variable.name: variable.type for variable in side.rule.variables}
    scene = ObjectUniverse(objects, side.rulebook.vocabulary, side.axioms)
    bindings = scene.bindings(side.rule.variables)
    columns = [monitor_function(side.rule.machine, binding, scene) for binding in bindings]
    machines = [side.rule.machine] * len(bindings)
    symbols = JointAlphabet(scene, columns).symbols
    return shortest_word(machines, [True] * len(bindings), symbols) is not None


def implied_by(side: AnalyzedRule, others: Sequence[AnalyzedRule]) -> tuple[AnalyzedRule, ...]:
    """One of the others, or few of them together, that forbid all that a rule forbids; else none.

    The others are taken together as far as their automata stay small; so more of them together may
    imply it without being found. Raises UndecidedError.
    """
    related = [analyzed_rule for analyzed_rule in others if are_related(side, analyzed_rule)]
    for analyzed_rule in related:
        if counterexample(side, [analyzed_rule]) is None:
            return (analyzed_rule,)
    premises = small_premises(side, related)
    if len(premises) < 2 or counterexample(side, premises) is not None:
        return ()
    for premise in premises:
        fewer = [analyzed_rule for analyzed_rule in premises if analyzed_rule is not premise]
        if counterexample(side, fewer) is None:
            premises = fewer
    return tuple(premises)


def small_premises(side: AnalyzedRule, related: Sequence[AnalyzedRule]) -> list[AnalyzedRule]:
    """Those of the others whose automata stay small together with that of the rule."""
    types = sorted(variable.type for variable in side.rule.variables)
    chosen: list[AnalyzedRule] = []
    for analyzed_rule in sorted(related, key=lambda rule: len(rule.rule.machine.successors)):
        if sorted(variable.type for variable in analyzed_rule.rule.variables) not in (types, []):
            continue
        sizes = [len(rule.rule.machine.successors) for rule in (side, *chosen, analyzed_rule)]
        if prod(sizes) <= MOST_JOINT_STATES and len(chosen) < MOST_PREMISES:
            chosen.append(analyzed_rule)
    return chosen
