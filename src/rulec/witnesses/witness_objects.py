"""The objects of the moment that a rule's count needs, as an example would name them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count as numbers_from
from itertools import islice, product

from rulec.logic.formula import Atom, Count, atoms_of
from rulec.rulebook.model import ExampleState, Variable
from rulec.vocabulary import Enumeration, Signal, Vocabulary
from rulec.witnesses.letter_witness import Facts, Witness, value_in_state

MOST_OBJECTS = 40
"""An example with more objects than these would not be read."""


@dataclass(frozen=True, slots=True)
class NamedObjects:
    """States of an example, and the objects in them besides those that the rule names."""

    objects: tuple[Variable, ...]
    states: tuple[ExampleState, ...]


def staged(
    states: Sequence[Witness], variables: Sequence[Variable], vocabulary: Vocabulary
) -> NamedObjects | None:
    """The states with objects that come to the counts that they need; None if it is not that easy.

    It is for a rule that counts nothing, or has a single count whose body compares no numbers and
    reads, besides the counted objects, only what the states give or what has a default.
    """
    counts = {count for state in states for count, _ in state.counts}
    if not counts:
        return NamedObjects((), tuple(state.facts for state in states))
    if len(counts) > 1:
        return None
    (count,) = counts
    scene = _Scene(count, variables, vocabulary)
    needs = []
    for state in states:
        facts = dict(state.facts)
        already = scene.add_named(facts)
        if already is None:
            return None
        needs.append((facts, state.counts[0][1] - already))
    most = max(need for _, need in needs)
    if most > MOST_OBJECTS or any(need < 0 for _, need in needs):
        return None
    taken = {variable.name for variable in variables}
    free = (f"{count.variable}{n}" for n in numbers_from(1))
    names = list(islice((name for name in free if name not in taken), most))
    for facts, need in needs:
        for number, name in enumerate(names):
            if not scene.add(facts, name, counted=number < need):
                return None
    objects = tuple(Variable(name, count.type) for name in names)
    return NamedObjects(objects, tuple(facts for facts, _ in needs))


class _Scene:
    """What can be said of an object so that it is counted, or is not."""

    def __init__(self, count: Count, variables: Sequence[Variable], vocabulary: Vocabulary) -> None:
        self._count = count
        self._vocabulary = vocabulary
        self._atoms = list(dict.fromkeys(atoms_of(count.body)))
        self._named = [
            variable.name
            for variable in variables
            if vocabulary.is_subtype(variable.type, count.type)
        ]

    def add_named(self, facts: Facts) -> int | None:
        """Say what is missing about the objects that the rule names; how many of them count."""
        counting = 0
        for name in self._named:
            if self.add(facts, name, counted=False):
                continue
            if not self.add(facts, name, counted=True):
                return None
            counting += 1
        return counting

    def add(self, facts: Facts, name: str, *, counted: bool) -> bool:
        """Say of an object what makes it count, or not; False, saying nothing, if that fails."""
        names = {self._count.variable: name}
        for more in self._choices(facts, names):
            if value_in_state(self._count.body, names, {**facts, **more}) is counted:
                facts.update(more)
                return True
        return False

    def _choices(self, facts: Facts, names: Mapping[str, str]) -> Iterator[Facts]:
        """All that the state leaves open and could say about what the body reads of an object."""
        open_values: dict[tuple[str, tuple[str, ...]], Sequence[bool | str]] = {}
        for atom in self._atoms:
            if not isinstance(atom, Atom):
                return
            key = (atom.name, tuple(names.get(one, one) for one in atom.arguments))
            if key not in facts:
                open_values[key] = self._values(atom)
        for values in product(*open_values.values()):
            yield dict(zip(open_values, values, strict=True))

    def _values(self, atom: Atom) -> Sequence[bool | str]:
        declaration = self._vocabulary.declarations[atom.name]
        assert isinstance(declaration, Enumeration | Signal), "a quantity is no atom"
        of_the_counted = self._count.variable in atom.arguments
        if not of_the_counted:
            # It is the same for all objects, so it cannot be chosen for one of them.
            return [] if declaration.default is None else [declaration.default]
        values: list[bool | str] = (
            list(declaration.values) if isinstance(declaration, Enumeration) else [False, True]
        )
        # What needs no word comes first.
        return sorted(values, key=lambda value: value != declaration.default)
