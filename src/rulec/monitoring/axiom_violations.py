"""Checks of axioms: finds states that contradict what the vocabulary says of every state."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.diagnostics import Diagnostic, Label, RulecError, SourceLocation
from rulec.logic.formula import Atom, Count
from rulec.logic.free_names import names_in, reads_in, rename_variables
from rulec.logic.kleene import Unknown, holds, number_of
from rulec.logic.printing import formula_text, term_text
from rulec.monitoring.monitoring_messages import VIOLATED_AXIOM
from rulec.monitoring.state_view import StateView
from rulec.rulebook.rules.axiom_instances import bound_to, counts
from rulec.trace import Value


class ImpossibleStateError(RulecError):
    """A state contradicts what the vocabulary says of every state (R0508)."""

    def __init__(self, diagnostic: Diagnostic, number: int) -> None:
        super().__init__(diagnostic)
        self.number = number

    def __reduce__(self) -> tuple[type[RulecError], tuple[Any, ...]]:
        return type(self), (self.diagnostics[0], self.number)


@dataclass(frozen=True, slots=True, eq=False)
class _AxiomInstance:
    """An axiom for particular objects."""

    axiom: CompiledAxiom
    bound: Mapping[str, str]

    def __str__(self) -> str:
        return f"`{formula_text(rename_variables(self.axiom.formula, self.bound))}`"

    def truth(self, view: StateView) -> bool | Unknown:
        """The truth value of the axiom in a state."""
        return holds(self.axiom.formula, self.bound, view)


class StatePlace(NamedTuple):
    """A state's number, its name in messages, and where it was read."""

    number: int
    name: str
    place: SourceLocation | None


def impossible_state(
    rule: CompiledRule,
    types: Mapping[str, str],
    axioms: Sequence[CompiledAxiom],
    view: StateView,
    place: StatePlace,
) -> ImpossibleStateError:
    """The error for a state whose letter, for objects of these types, no possible state has."""
    about_letters = [axiom for axiom in axioms if not counts(axiom.formula)]
    truths = {instance: instance.truth(view) for instance in _instances(about_letters, types, view)}
    broken = [instance for instance, truth in truths.items() if truth is False][:1]
    # Each axiom may hold by itself, but no completion satisfies all of them.
    broken = broken or [instance for instance, truth in truths.items() if truth is not True]
    return _error(broken, view, place, f"rule `{rule.name}` depends on it")


def check_counting_axioms(
    rulebook: CompiledRulebook,
    n_states: int,
    view: Callable[[int], StateView],
    where: Callable[[int], str],
    place: SourceLocation | None,
) -> None:
    """Check the counting axioms in every state, for the objects present.

    Checks only axioms about something that a rule reads: the machines do not know these axioms.
    Raises RulecError R0508.
    """
    counting = [axiom for axiom in rulebook.axioms if counts(axiom.formula)]
    if not counting:
        return
    read = {name for rule in rulebook.rules for name in names_in(rule.formula)}
    counting = [axiom for axiom in counting if not read.isdisjoint(names_in(axiom.formula))]
    for number in range(n_states):
        state = view(number)
        for instance in _instances(counting, state.objects, state):
            if instance.truth(state) is False:
                raise _error([instance], state, StatePlace(number, where(number), place))


def _instances(
    axioms: Sequence[CompiledAxiom], types: Mapping[str, str], view: StateView
) -> Iterator[_AxiomInstance]:
    for axiom in axioms:
        for bound in bound_to(axiom.variables, types, view.vocabulary):
            yield _AxiomInstance(axiom, bound)


def _error(
    broken: Sequence[_AxiomInstance], view: StateView, state: StatePlace, *why: str
) -> ImpossibleStateError:
    axioms = " and ".join(map(str, broken))
    hold = "holds" if len(broken) == 1 else "hold"
    places = dict.fromkeys(instance.axiom.place for instance in broken)
    values = dict.fromkeys(value for instance in broken for value in _values(instance, view))
    labels = []
    notes = [f"here {', '.join(values)}"]
    for axiom_place in filter(None, places):
        if axiom_place.excerpt:
            labels.append(Label(axiom_place, "what holds in every state"))
        else:
            # A compiled rulebook has no source text to show.
            notes.append(f"the fact is in {axiom_place.file}, line {axiom_place.line}")
    diagnostic = VIOLATED_AXIOM.at(
        state.place,
        f"{state.name} cannot be: {axioms} {hold} in every state",
        help="correct the state; or the fact, if there can be such states",
        labels=tuple(labels),
        notes=(*notes, *why),
    )
    return ImpossibleStateError(diagnostic, state.number)


def _values(instance: _AxiomInstance, view: StateView) -> Iterator[str]:
    for read in reads_in(instance.axiom.formula):
        value: Value | Unknown | Fraction
        if isinstance(read, Count):
            text, value = term_text(read), number_of(read, instance.bound, view)
        else:
            items = tuple(instance.bound[variable] for variable in read.arguments)
            text, value = str(Atom(read.name, items)), view.value(read.name, items)
        if not isinstance(value, Unknown):
            yield f"`{text}` is {str(value).lower() if isinstance(value, bool) else value}"
