"""The vocabulary as resolved data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import permutations, product
from types import MappingProxyType

from rulec.resource_limits import CHOICES
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class ObjectType:
    """Type of traffic participant, perhaps a subtype of another one.

    Every object of it is also one of ``parent``.
    """

    name: str
    parent: str | None = None


@dataclass(frozen=True, slots=True)
class Enumeration:
    """State, global or per object, with one of ``values`` at a time.

    ``parameters`` are the names of the object types it is about: none for a global one. Every value
    is an atom of the language, so values are unique within a vocabulary.
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
    """Number with a unit (as written, ``km/h``), global or per object."""

    name: str
    parameters: tuple[str, ...]
    unit: str
    default: float | None = None
    constant: bool = False
    presumed: bool = False


Declaration = Enumeration | Signal | Quantity
"""What can be said of a state. ``constant``: it stays the same as long as a trace goes on.
``presumed``: where no source tells it, its default holds, and verdicts name it."""


def values_of(declaration: Declaration) -> tuple[str, ...] | tuple[bool, ...]:
    """The values of an enumeration, in their order, or of a signal."""
    return declaration.values if isinstance(declaration, Enumeration) else (False, True)


def least_value(declaration: Declaration) -> bool | float | str:
    """The first value, or zero."""
    return 0.0 if isinstance(declaration, Quantity) else values_of(declaration)[0]


def default_value(declaration: Declaration) -> bool | float | str:
    """The default, or else the least value."""
    return least_value(declaration) if declaration.default is None else declaration.default


@dataclass(frozen=True)
class Vocabulary:
    """Types and declarations by name, in order of declaration."""

    __repr__ = short_repr

    name: str
    types: Mapping[str, ObjectType] = field(default_factory=lambda: MappingProxyType({}))
    declarations: Mapping[str, Declaration] = field(default_factory=lambda: MappingProxyType({}))
    implied: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))
    """Signal -> those of the same objects that facts say it implies, where a state has none."""

    def __reduce__(self) -> tuple[type[Vocabulary], tuple[object, ...]]:
        # Read-only views of dictionaries cannot be pickled.
        own = self.name, dict(self.types), dict(self.declarations), dict(self.implied)
        return Vocabulary, own

    @cached_property
    def enumeration_of(self) -> Mapping[str, Enumeration]:
        """Value name -> the enumeration it belongs to."""
        return {
            value: item
            for item in self.declarations.values()
            if isinstance(item, Enumeration)
            for value in item.values
        }

    @cached_property
    def constants(self) -> tuple[str, ...]:
        """The names whose values stay the same as long as a trace goes on."""
        return tuple(name for name, item in self.declarations.items() if item.constant)

    def ancestors(self, type_name: str) -> Iterator[str]:
        """The type itself, its parent, and so on upward."""
        current: str | None = type_name
        while current is not None:
            yield current
            current = self.types[current].parent

    def is_subtype(self, type_name: str, of: str) -> bool:
        """Tell whether every ``type_name`` is also an ``of``: never, where it is not declared."""
        return of in self._above.get(type_name, ())

    @cached_property
    def _above(self) -> Mapping[str, frozenset[str]]:
        return {name: frozenset(self.ancestors(name)) for name in self.types}


def choices(
    types: Sequence[str], objects: Mapping[str, str], vocabulary: Vocabulary, whose: str = ""
) -> Iterator[tuple[str, ...]]:
    """All choices of distinct objects for the types.

    ``objects`` maps each object to its type.

    An object of a subtype fits, too. Of no types there is one choice, the empty one.

    Raises RulecError R0718, which names ``whose`` they are, if there are more than the limit
    `choices`.
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
    """How many ``choices`` there are, without going through them.

    Types are a forest, so what fits one is all, some or none of what fits another. Where the
    narrower ones choose first, each has taken one from whatever is above it. Nothing is of a type
    that is not declared, such as one in a vocabulary with mistakes.
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
