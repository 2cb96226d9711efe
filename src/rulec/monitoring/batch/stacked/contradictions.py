"""Finds traces in arrays whose states may contradict axioms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from rulec.array_types import Indices
from rulec.automata.bundle.compiled_rulebook import CompiledAxiom
from rulec.logic.formula import Atom, atoms_of
from rulec.logic.free_names import names_of
from rulec.monitoring.batch.columns.column_numbers import Mask, alike_places
from rulec.monitoring.batch.stacked.stack import Stack
from rulec.monitoring.batch.stacked.stack_reader import Spots, StackReader
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions.completions import can_be
from rulec.monitoring.uncertainty.state_letters.related_facts import related_facts
from rulec.vocabulary.partial_values import PartialValue


@dataclass(frozen=True, slots=True, eq=False)
class LinkedFacts:
    """Axioms that share names.

    Whether some state can contradict them is cached by the values that ``signals`` have anywhere.
    """

    facts: tuple[CompiledAxiom, ...]
    signals: tuple[str, ...]
    names: frozenset[str]
    _kept: dict[tuple[int | None, ...], bool] = field(default_factory=dict, init=False)

    def are_kept(self, reader: StackReader) -> bool:
        """Whether the values that occur anywhere show that no state contradicts the axioms."""
        key = tuple([reader.met_values.with_default(name) for name in self.signals])
        known = self._kept.get(key)
        if known is None:
            truths = [reader.met_values.truth_anywhere(fact.formula) for fact in self.facts]
            known = all(bool(truth.sure) for truth in truths) or self._can_all_be(reader)
            self._kept[key] = known
        return known

    def _can_all_be(self, reader: StackReader) -> bool:
        """Whether the axioms are only about signals of the world and allow all their values."""
        stack, compared = reader.stack, self.names - set(self.signals)
        if compared or any(fact.variables for fact in self.facts):
            return False
        values: dict[tuple[str, tuple[str, ...]], PartialValue | None] = {
            (name, ()): reader.met_values.only_value(name) for name in self.signals
        }
        if None in values.values():
            return False
        return can_be(StateView(with_values({}, values), {}, stack.vocabulary), self.facts)


_OBJECT = "an object"


def contradicted(linked_facts: Sequence[LinkedFacts], reader: StackReader) -> set[int]:
    """All traces with a state that contradicts axioms (each ``is_of_one``), and possibly others.

    Raises UnencodableError.
    """
    places = [
        _contradicted_states(group, reader, spots, objects)
        for together in linked_facts
        if not together.are_kept(reader)
        for group, spots, objects in _facts_at_spots(together.facts, reader.stack)
    ]
    if not places:
        return set()
    states = np.unique(np.concatenate(places))
    rows: list[int] = np.unique(reader.stack.begins.searchsorted(states, side="right") - 1).tolist()
    return set(rows)


def linked(facts: Sequence[CompiledAxiom]) -> Iterator[LinkedFacts]:
    """The axioms in groups that share no names."""
    while facts:
        group = related_facts(names_of(facts[0].formula), facts)
        atoms = [atom for fact in group for atom in atoms_of(fact.formula)]
        signals = dict.fromkeys(atom.name for atom in atoms if isinstance(atom, Atom))
        names = frozenset(name for fact in group for name in names_of(fact.formula))
        yield LinkedFacts(group, tuple(signals), names)
        facts = [fact for fact in facts if fact not in group]


_Asked = tuple[Sequence[CompiledAxiom], Spots, Mapping[str, str]]


def _facts_at_spots(together: Sequence[CompiledAxiom], stack: Stack) -> Iterator[_Asked]:
    """Axioms that are evaluated at the same spots, with the type of their object, if any."""
    if not together[0].variables:
        yield together, Spots(np.arange(stack.n_states), {}, whole=True), {}
        return
    by_facts: dict[tuple[CompiledAxiom, ...], list[str]] = {}
    for kind in stack.kinds:
        own = [x for x in together if stack.vocabulary.is_subtype(kind, x.variables[0].type)]
        by_facts.setdefault(tuple(own), []).append(kind)
    for group, kinds in by_facts.items():
        if group:
            suits = np.array([kind in kinds for kind in stack.kinds])[stack.kind_of]
            cells = suits[stack.object_of].nonzero()[0]
            spots = Spots(stack.state_of[cells], {_OBJECT: cells})
            yield group, spots, {_OBJECT: kinds[0]}


def _contradicted_states(
    facts: Sequence[CompiledAxiom], reader: StackReader, spots: Spots, objects: Mapping[str, str]
) -> Indices:
    """The states of those spots in which some of the linked axioms cannot all hold."""
    holds: Mask = np.True_
    for fact in facts:
        holds = holds & reader.truth(fact.formula, spots, _OBJECT).sure
    doubtful = (~np.broadcast_to(holds, len(spots.states))).nonzero()[0]
    if not len(doubtful):
        return doubtful
    spots = spots.part(doubtful)
    names = sorted(frozenset().union(*[names_of(fact.formula) for fact in facts]))
    kinds = _alike(names, reader.stack, spots)
    examples = np.zeros(int(kinds.max()) + 1, dtype=np.intp)
    examples[kinds] = np.arange(len(kinds))
    items = tuple(objects)
    columns = [reader.values_at(name, items, spots.part(examples)) for name in names]
    broken = []
    for values in zip(*columns, strict=True):
        state = {(name, items): value for name, value in zip(names, values, strict=True)}
        view = StateView(with_values({}, state), objects, reader.stack.vocabulary)
        broken.append(not can_be(view, facts))
    contradicting: Indices = spots.states[np.array(broken)[kinds]]
    return contradicting


def _alike(names: Sequence[str], stack: Stack, spots: Spots) -> Indices:
    """A group number from 0 for each spot; spots of one group have states with the same values."""
    where = spots.cells.get(_OBJECT, spots.states)
    columns = (column for name in names if (column := stack.column(name)) is not None)
    parts = (part for own in columns for part in (own.values, own.upper, own.unknown))
    return alike_places((part[where] for part in parts if part is not None), len(where))
