"""The vocabulary after name resolution."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import permutations, product
from types import MappingProxyType
from typing import Any

from rulec.resource_limits import CHOICES
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class ObjectType:
    """Type of traffic participant; a subtype of ``parent`` if that is given.

    Every object of a type is also an object of its parent.
    """

    name: str
    parent: str | None = None


@dataclass(frozen=True, slots=True)
class Enumeration:
    """A variable, global or per object, that has exactly one of ``values`` at a time.

    ``parameters`` are the object types of its arguments, empty for a global one. Every value is an
    atom of the language, so values are unique within a vocabulary.
    """

    name: str
    parameters: tuple[str, ...]
    values: tuple[str, ...]
    default: str | None = None
    constant: bool = False
    presumed: bool = False


@dataclass(frozen=True, slots=True)
class Signal:
    """A Boolean, global or per object."""

    name: str
    parameters: tuple[str, ...] = ()
    default: bool | None = None
    constant: bool = False
    presumed: bool = False


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with a unit as written (``km/h``), global or per object."""

    name: str
    parameters: tuple[str, ...]
    unit: str
    default: float | None = None
    constant: bool = False
    presumed: bool = False


Declaration = Enumeration | Signal | Quantity
"""Something that states give values for.

``constant``: the value never changes within a trace. ``presumed``: where no source provides the
value, the default holds and verdicts mention it.
"""


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a signal means for the objects of its ``variables``, where no source tells it.

    ``formula`` is one of `logic`, which stands above this room. It looks at the present and the
    past only, and ``reads`` these names.
    """

    variables: tuple[str, ...]
    formula: Any
    reads: frozenset[str]


def values_of(declaration: Declaration) -> tuple[str, ...] | tuple[bool, ...]:
    """The values of an enumeration, in their order, or of a signal."""
    return declaration.values if isinstance(declaration, Enumeration) else (False, True)


def least_value(declaration: Declaration) -> bool | float | str:
    """The first value of an enumeration, False for a signal, 0 for a quantity."""
    return 0.0 if isinstance(declaration, Quantity) else values_of(declaration)[0]


def default_value(declaration: Declaration) -> bool | float | str:
    """The declared default, or ``least_value`` if there is none."""
    return least_value(declaration) if declaration.default is None else declaration.default


@dataclass(frozen=True)
class Vocabulary:
    """Types and declarations by name, in order of declaration."""

    __repr__ = short_repr

    name: str
    types: Mapping[str, ObjectType] = field(default_factory=lambda: MappingProxyType({}))
    declarations: Mapping[str, Declaration] = field(default_factory=lambda: MappingProxyType({}))
    implied: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))
    """Signal -> signals of the same objects that facts say it implies, where a state omits them."""
    meanings: Mapping[str, Meaning] = field(default_factory=lambda: MappingProxyType({}))
    """Signals that are defined, each after those that its meaning reads."""
    parameters: Mapping[str, Fraction] = field(default_factory=lambda: MappingProxyType({}))
    """What definitions depend on and a rulebook may set: numbers in base units."""

    def __reduce__(self) -> tuple[type[Vocabulary], tuple[object, ...]]:
        # Read-only views of dictionaries cannot be pickled.
        own = self.name, dict(self.types), dict(self.declarations), dict(self.implied)
        return Vocabulary, (*own, dict(self.meanings), dict(self.parameters))

    @cached_property
    def enumeration_of(self) -> Mapping[str, Enumeration]:
        """Each enumeration value's name -> its enumeration."""
        return {
            value: item
            for item in self.declarations.values()
            if isinstance(item, Enumeration)
            for value in item.values
        }

    @cached_property
    def constants(self) -> tuple[str, ...]:
        """The names whose values never change within a trace."""
        return tuple(name for name, item in self.declarations.items() if item.constant)

    def ancestors(self, type_name: str) -> Iterator[str]:
        """The type itself, its parent, and so on upward."""
        current: str | None = type_name
        while current is not None:
            yield current
            current = self.types[current].parent

    def is_subtype(self, type_name: str, of: str) -> bool:
        """Whether every ``type_name`` is also an ``of``; False if ``type_name`` is not declared."""
        return of in self._above.get(type_name, ())

    @cached_property
    def _above(self) -> Mapping[str, frozenset[str]]:
        return {name: frozenset(self.ancestors(name)) for name in self.types}


def choices(
    types: Sequence[str], objects: Mapping[str, str], vocabulary: Vocabulary, whose: str = ""
) -> Iterator[tuple[str, ...]]:
    """All choices of distinct objects for the types; for no types the single, empty one.

    ``objects`` maps each object to its type; objects of a subtype fit, too. Raises RulecError R0718
    if there are more than the limit `choices`; its message names ``whose`` choices they are.
    """
    if len(types) > 1:
        CHOICES.within(number_of_choices(types, objects, vocabulary), None, whose)
    fitting = [fitting_objects(type_name, objects, vocabulary) for type_name in types]
    if len(set(types)) == 1:
        yield from permutations(fitting[0], len(types))
        return
    for chosen in product(*fitting):
        if len(set(chosen)) == len(chosen):
            yield chosen


def fitting_objects(
    type_name: str, objects: Mapping[str, str], vocabulary: Vocabulary
) -> list[str]:
    """The objects of a type or of one of its subtypes."""
    return [item for item, kind in objects.items() if vocabulary.is_subtype(kind, type_name)]


def number_of_choices(
    types: Sequence[str], objects: Mapping[str, str], vocabulary: Vocabulary
) -> int:
    """The number of ``choices``, computed without enumerating them.

    Types form a forest, so the objects of one type contain, are among, or are disjoint from those
    of another. If narrower types choose first, each has used up one object of every type above it.
    A type that is not declared, as in a vocabulary with mistakes, has no objects.
    """
    if not vocabulary.types.keys() >= set(types):
        return 0
    depth = {name: len(list(vocabulary.ancestors(name))) for name in set(types)}
    number_of = {name: len(fitting_objects(name, objects, vocabulary)) for name in depth}
    number = 1
    before: list[str] = []
    for name in sorted(types, key=depth.__getitem__, reverse=True):
        taken = sum(vocabulary.is_subtype(other, name) for other in before)
        number *= max(number_of[name] - taken, 0)
        before.append(name)
    return number
