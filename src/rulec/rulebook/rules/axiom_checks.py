"""Check of examples against axioms, which hold in every state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from rulec.diagnostics import Diagnostic, Label
from rulec.diagnostics.diagnostic import at
from rulec.logic.kleene import Unknown, holds
from rulec.logic.printing import formula_text
from rulec.logic.renaming import rename_variables
from rulec.logic.required_inputs import required_inputs
from rulec.rulebook.rulebook_model import Axiom, Example, ExampleState, Rule
from rulec.rulebook.rules.example_messages import CONTRADICTORY_STATE
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.object_choices import choices


@dataclass(frozen=True, slots=True)
class ExampleValues:
    """Values of an example's state, and defaults for others read.

    What neither of them speaks of is not known. ``read`` are those: declarations and objects.
    """

    said: ExampleState
    read: frozenset[tuple[str, tuple[str, ...]]]
    objects: Mapping[str, str]
    vocabulary: Vocabulary

    def value(self, name: str, items: tuple[str, ...]) -> bool | float | str | Unknown:
        """The value of a signal or an enumeration."""
        result = self.said.get((name, items))
        if result is None and (name, items) in self.read:
            result = self.vocabulary.declarations[name].default
        return Unknown(name, items) if result is None else result

    def number(self, name: str, items: tuple[str, ...]) -> Fraction | Unknown:
        """The value of a quantity."""
        unknown = self.value(name, items)
        # A number's decimals are what is written.
        return unknown if isinstance(unknown, Unknown) else Fraction(repr(unknown))


def contradicted(
    rule: Rule, axioms: Sequence[Axiom], vocabulary: Vocabulary
) -> Iterator[Diagnostic]:
    """Mistakes (R0306), one per state of examples that contradicts an axiom."""
    for example in rule.examples if axioms else ():
        objects = {item.name: item.type for item in (*rule.variables, *example.objects)}
        read = frozenset(
            (required_input_.name, required_input_.arguments)
            for required_input_ in required_inputs(rule.formula, objects, vocabulary.is_subtype)
        )
        for number, state in enumerate(example.states):
            broken = _broken(ExampleValues(state, read, objects, vocabulary), axioms)
            if broken is not None:
                yield _no_state(example, number, *broken)


def _broken(state: ExampleValues, axioms: Sequence[Axiom]) -> tuple[Axiom, str] | None:
    """The first violated axiom, and its text about the chosen objects."""
    for fact in axioms:
        names = [variable.name for variable in fact.variables]
        types = [variable.type for variable in fact.variables]
        for chosen in choices(types, state.objects, state.vocabulary):
            bound = dict(zip(names, chosen, strict=True))
            if holds(fact.formula, bound, state) is False:
                return fact, formula_text(rename_variables(fact.formula, bound))
    return None


def _no_state(example: Example, number: int, fact: Axiom, said: str) -> Diagnostic:
    spans = example.state_spans
    return CONTRADICTORY_STATE.at(
        spans[number].place if spans else at(example.span),
        f"this state cannot be: `{said}` holds in every state",
        help="correct the state; or the fact, if there can be such states",
        labels=(Label(fact.span.place, "what holds in every state"),) if fact.span else (),
    )
