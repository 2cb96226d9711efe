"""States that cannot be: which fact they contradict."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rulec.automata.axiom_instances import counts
from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.diagnostics import Diagnostic, Label, RulecError, SourceLocation
from rulec.logic.formula import Atom, Count, Term, atoms_of
from rulec.logic.free_names import names_in
from rulec.logic.kleene import Unknown, holds, number_of
from rulec.logic.printing import formula_text, term_text
from rulec.logic.renaming import rename_variables
from rulec.monitoring.monitoring_messages import VIOLATED_AXIOM
from rulec.monitoring.state_view import StateView
from rulec.vocabulary.object_choices import choices


class ImpossibleStateError(RulecError):
    """A state contradicts what the vocabulary knows of every state (R0508).

    ``number`` is the state's.
    """

    def __init__(self, diagnostic: Diagnostic, number: int) -> None:
        super().__init__(diagnostic)
        self.number = number

    def __reduce__(self) -> tuple[type[RulecError], tuple[Any, ...]]:
        return type(self), (self.diagnostics[0], self.number)


@dataclass(frozen=True, slots=True)
class _Said:
    """A fact, said of objects."""

    fact: CompiledAxiom
    bound: Mapping[str, str]

    def __str__(self) -> str:
        return f"`{formula_text(rename_variables(self.fact.formula, self.bound))}`"


def impossible(
    rule: CompiledRule,
    objects: Mapping[str, str],
    axioms: Sequence[CompiledAxiom],
    moment: StateView,
    number: int,
    where: str,
    place: SourceLocation | None,
) -> ImpossibleStateError:
    """The error about a state whose letter the rule's machine cannot meet.

    ``objects`` are those of the rule's variables, ``where`` names the state.
    """
    types = {objects[variable.name]: variable.type for variable in rule.variables}
    said = list(_instances([one for one in axioms if not counts(one.formula)], types, moment))
    truths = [holds(one.fact.formula, one.bound, moment) for one in said]
    broken = [one for one, truth in zip(said, truths, strict=True) if truth is False][:1]
    if not broken:
        # Each may hold by itself: what is not said cannot be so that all of them do.
        broken = [one for one, truth in zip(said, truths, strict=True) if truth is not True]
    return _error(broken, moment, number, where, place, f"rule `{rule.name}` depends on it")


def check_counting_axioms(
    rulebook: CompiledRulebook,
    n_states: int,
    moment: Callable[[int], StateView],
    where: Callable[[int], str],
    place: SourceLocation | None,
) -> None:
    """Facts that count hold in every state, of the objects that are there, if a rule needs to know.

    It does if it reads something that the fact speaks of. Machines know nothing of such facts.

    Raises:
        RulecError: R0508.
    """
    counting = [one for one in rulebook.axioms if counts(one.formula)]
    if not counting:
        return
    read = {name for rule in rulebook.rules for name in names_in(rule.formula)}
    counting = [one for one in counting if not read.isdisjoint(names_in(one.formula))]
    for number in range(n_states):
        there = moment(number)
        for said in _instances(counting, there.objects, there):
            if holds(said.fact.formula, said.bound, there) is False:
                raise _error([said], there, number, where(number), place, "")


def _instances(
    axioms: Sequence[CompiledAxiom], types: Mapping[str, str], moment: StateView
) -> Iterator[_Said]:
    for fact in axioms:
        wanted = [variable.type for variable in fact.variables]
        for chosen in choices(wanted, types, moment.vocabulary):
            names = [variable.name for variable in fact.variables]
            yield _Said(fact, dict(zip(names, chosen, strict=True)))


def _error(
    broken: Sequence[_Said],
    moment: StateView,
    number: int,
    where: str,
    place: SourceLocation | None,
    why: str,
) -> ImpossibleStateError:
    said = " and ".join(map(str, broken))
    places = dict.fromkeys(one.fact.place for one in broken if one.fact.place is not None)
    values = dict.fromkeys(value for one in broken for value in _values(one, moment))
    # A compiled rulebook has no text to show.
    unseen = [f"the fact is in {one.file}, line {one.line}" for one in places if not one.excerpt]
    return ImpossibleStateError(
        VIOLATED_AXIOM.at(
            place,
            f"{where} cannot be: {said} {'holds' if len(broken) == 1 else 'hold'} in every state",
            help="correct the state; or the fact, if there can be such states",
            labels=tuple(Label(one, "what holds in every state") for one in places if one.excerpt),
            notes=(f"here {', '.join(values)}", *unseen, *([why] if why else [])),
        ),
        number,
    )


def _values(said: _Said, moment: StateView) -> Iterator[str]:
    """The values of what a fact speaks of, in words; of what is known of it."""
    for one in atoms_of(said.fact.formula):
        for read in (one,) if isinstance(one, Atom) else (term for _, term in one.terms):
            value = _value(read, said.bound, moment)
            if value is not None:
                yield value


def _value(read: Atom | Term, bound: Mapping[str, str], moment: StateView) -> str | None:
    if isinstance(read, Count):
        number = number_of(read, bound, moment)
        return None if isinstance(number, Unknown) else f"`{term_text(read)}` is {number}"
    items = tuple(bound[one] for one in read.arguments)
    value = moment.value(read.name, items)
    if isinstance(value, Unknown):
        return None
    return (
        f"`{Atom(read.name, items)}` is {str(value).lower() if isinstance(value, bool) else value}"
    )
