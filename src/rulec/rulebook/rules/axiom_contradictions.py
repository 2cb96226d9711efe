"""Axioms that exclude all states, and rules whose trigger is excluded.

These are found without automata if few values have to be tried; the rest is left to the compiler
and to `rulec analyze`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from rulec.diagnostics import Diagnostic, Label, Span
from rulec.diagnostics.code import Code
from rulec.logic import formula as ltl
from rulec.logic.formula import Formula
from rulec.logic.printing import formula_text
from rulec.rulebook.rulebook_model import Axiom, Rule, Variable
from rulec.rulebook.rules.antecedents import antecedents, has_constant
from rulec.rulebook.rules.axiom_instances import (
    AxiomInstance,
    axiom_instances,
    linked,
    subjects_of,
)
from rulec.rulebook.rules.possible_states import may_hold
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import number_of_choices

CONTRADICTORY_AXIOMS = Code(
    "R0409",
    title="facts contradict each other",
    why="A `fact` holds in every state. If several facts cannot hold together, or one cannot hold "
    "at all, there is no state to judge. The message names a minimal set of contradictory facts.",
    bad="rulebook example\nsignal wet, fog default false\nfact wet or fog\nfact not wet\n"
    "fact not fog\nhard rule r { require always not (wet and fog) }\n",
    good="rulebook example\nsignal wet, fog default false\nfact not (wet and fog)\n"
    "hard rule r { require always not wet }\n",
)

IMPOSSIBLE_TRIGGER = Code(
    "R0363",
    title="what triggers a rule is possible in no state",
    why="The left side of an `implies` that always holds, the first phase of a forbidden "
    "sequence, a condition (`when`), an exception (`unless`), or everything that a rule forbids "
    "is impossible in every state, so the rule or its exception has no effect. A number cannot be "
    "both above 22 and below 6, and an enumeration has only one value: if one of them suffices, "
    "write `or`. Or facts exclude it: then either a fact says too much, or the rule is not "
    "needed. The message names a minimal set of facts that exclude it. `rulec analyze` also "
    "considers sequences of states (R0805).",
    bad="rulebook example\nsignal parked, standing, lit default false\n"
    "fact parked implies standing\n"
    "hard rule r { require always (parked and not standing implies lit) }\n",
    good="rulebook example\nsignal parked, standing, lit default false\n"
    "fact parked implies standing\n"
    "hard rule r { require always (parked and standing implies lit) }\n",
)


_MOST_INSTANCES = 200
"""The most instances of axioms that are examined together."""


def contradictions(
    variables: Sequence[Variable], axioms: Sequence[Axiom], vocabulary: Vocabulary
) -> Iterator[Diagnostic]:
    """Errors (R0409) for axioms that exclude all states of the objects that variables stand for.

    No axiom is in two of them.
    """
    for group in _groups(variables, axioms, vocabulary):
        rest = list(group)
        while not may_hold([instance.formula for instance in rest], vocabulary):
            needed = _needed(rest, (), vocabulary)
            yield contradictory_facts(needed, variables)
            reported = {id(instance.fact) for instance in needed}
            rest = [instance for instance in rest if id(instance.fact) not in reported]


def all_contradictions(axioms: Sequence[Axiom], vocabulary: Vocabulary) -> list[Diagnostic]:
    """The same for the objects in each of the axioms, with each set of axioms once."""
    scenes = dict.fromkeys(axiom.variables for axiom in axioms)
    diagnostics: dict[object, Diagnostic] = {}
    for variables in sorted(scenes, key=len):
        for diagnostic in contradictions(variables, axioms, vocabulary):
            diagnostics.setdefault((diagnostic.place, diagnostic.message), diagnostic)
    return list(diagnostics.values())


def impossible_triggers(
    rule: Rule, axioms: Sequence[Axiom], vocabulary: Vocabulary, span: Span | None
) -> Iterator[Diagnostic]:
    """Warnings (R0363), about a place, for triggers that no state can satisfy.

    An axiom that an option switches on says nothing about the rulebook with another option.
    """
    lasting = [axiom for axiom in axioms if not has_constant(axiom.formula)]
    groups = [*_groups(rule.variables, lasting, vocabulary)]
    for role, trigger in _triggers(rule):
        about = {ltl.subject_of(atom) for atom in ltl.atoms_of(trigger)}
        related = [instance for group in groups if subjects_of(group) & about for instance in group]
        if may_hold([trigger, *(instance.formula for instance in related)], vocabulary):
            continue
        needed = _needed(related, (trigger,), vocabulary)
        yield _ruled_out(role, trigger, needed, span)


def _groups(
    variables: Sequence[Variable], axioms: Sequence[Axiom], vocabulary: Vocabulary
) -> Iterator[tuple[AxiomInstance, ...]]:
    """Instances of axioms in independent groups; none if there are too many."""
    objects = {variable.name: variable.type for variable in variables}
    types = ([variable.type for variable in axiom.variables] for axiom in axioms)
    number = sum(number_of_choices(own, objects, vocabulary) for own in types)
    if number <= _MOST_INSTANCES:
        yield from linked(axiom_instances(variables, axioms, vocabulary))


def _triggers(rule: Rule) -> Iterator[tuple[str, ltl.Formula]]:
    for antecedent in antecedents(rule):
        yield f"{antecedent.in_words} of rule `{rule.name}`", antecedent.formula
    match rule.required or rule.formula:
        case ltl.Unary(ltl.UnaryOperator.NEVER, operand) if not has_constant(operand):
            yield f"what rule `{rule.name}` forbids", operand


def _needed(
    instances: Sequence[AxiomInstance], others: Sequence[ltl.Formula], vocabulary: Vocabulary
) -> tuple[AxiomInstance, ...]:
    """A minimal set of instances that cannot hold together with other formulas."""
    needed = [*instances]
    for instance in instances:
        fewer = [axiom for axiom in needed if axiom is not instance]
        if not may_hold([*others, *(axiom.formula for axiom in fewer)], vocabulary):
            needed = fewer
    return tuple(needed)


def contradictory_facts(
    instances: Iterable[AxiomInstance], variables: Sequence[Variable]
) -> Diagnostic:
    """R0409: axioms that contradict each other for the objects that variables stand for."""
    instances = tuple(instances)
    first, *others = axioms = _facts_of(instances)
    types = {variable.name: variable.type for variable in variables}
    objects = {name for instance in instances for name in instance.variables}
    number = Counter(types[name] for name in objects)
    kinds = [
        f"a `{type_}`" if several == 1 else f"{several} objects of type `{type_}`"
        for type_, several in sorted(number.items())
    ]
    return CONTRADICTORY_AXIOMS.at(
        first.span,
        f"these facts contradict each other: {_in_words(axioms)}"
        if others
        else f"{_in_words(axioms)} can never be a fact",
        expected="no state can be so",
        help="a fact is what holds in every state: correct or remove "
        + ("one of them" if others else "it"),
        labels=_labels(others, "and so"),
        notes=(f"there would be no state with {' and '.join(kinds)}",) if kinds else (),
    )


def _ruled_out(
    role: str, trigger: Formula, instances: Iterable[AxiomInstance], span: Span | None
) -> Diagnostic:
    """R0363: a rule's trigger, named by ``role``, is excluded, possibly by axioms."""
    axioms = _facts_of(instances)
    many = "s" if len(axioms) > 1 else ""
    return IMPOSSIBLE_TRIGGER.at(
        span,
        f"{role} can never be: `{formula_text(trigger)}`",
        expected=f"ruled out by the fact{many} {_in_words(axioms)}"
        if axioms
        else "no state can be so",
        help="correct the rule or the fact; as they stand, this part of the rule has no effect"
        if axioms
        else "a number has one value at a time, and so has an enumeration; where one of these is "
        "enough write `or`",
        labels=_labels(axioms, "this holds in every state"),
        severity="warning",
    )


def _facts_of(instances: Iterable[AxiomInstance]) -> list[Axiom]:
    return list(dict.fromkeys(instance.fact for instance in instances))


def _in_words(axioms: Iterable[Axiom]) -> str:
    return ", ".join(f"`{formula_text(axiom.formula)}`" for axiom in axioms)


def _labels(axioms: Iterable[Axiom], words: str) -> tuple[Label, ...]:
    spans = (axiom.span for axiom in axioms)
    return tuple(Label(span.place, words) for span in spans if span is not None)
