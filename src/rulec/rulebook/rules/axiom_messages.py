"""Messages about axioms that exclude all states, or all in which a rule requires anything."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from rulec.diagnostics import Diagnostic, Label, Span
from rulec.diagnostics.code import Code
from rulec.logic.formula import Formula
from rulec.logic.printing import formula_text
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.rulebook.rules.axiom_instances import AxiomInstance

CONTRADICTORY_AXIOMS = Code("R0409")

IMPOSSIBLE_TRIGGER = Code("R0363")


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


def ruled_out(
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
