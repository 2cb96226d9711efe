"""The fields of a monitor's input: the names of the vocabulary that its rules read."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.mealy_monitor import Read
from rulec.code_generation.code_messages import too_large
from rulec.code_generation.written_names import Identifiers
from rulec.logic.free_names import names_in
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN_TYPES

NOBODY_KNOWN = "object"
"""The type used for a vocabulary without types."""

TYPE, RULE = " type", " rule"
"""Keys that cannot be names of enumerations."""

_OWN = """
    SATISFIED HOLDS_SO_FAR PENDING VIOLATED OK NULL BAD_TYPE TWICE TOO_MANY EXCLUDED_BY_FACTS
    UNKNOWN UNKNOWN_NUMBER RULES TYPES SEATS MOST_OBJECTS N_SOURCES STEP_S VARIABLES INSTANCES WORDS
    WORLD_READS OWN_READS SHARED_READS CELL_WORDS CLASS_WORDS STATE_WORDS SOURCES MONITOR_H
    MONITOR_HPP NODES ENTRIES PLACES MOST_DIGIT OWN SHARED DIGITS TOGETHER LEAST GREATEST
    KNOWN FROM_TO MOST NO PERHAPS YES NOBODY EMPTY SEVERAL LEAF EXCLUDED EXACTLY WITHIN LOST DOUBTED
    GONE
"""
_OWN_CONSTANTS = frozenset(_OWN.split())
"""The constants that a monitor defines itself, independent of its rulebook."""

MOST_VALUES = 254
"""The most values of an enumeration; 255 means unknown."""


@dataclass(frozen=True)
class InputFields:
    """The names that are read, in order of declaration, and their identifiers."""

    vocabulary: Vocabulary
    read: tuple[Declaration, ...]
    rules: tuple[str, ...]

    @cached_property
    def types(self) -> tuple[str, ...]:
        """All types of objects; at least one."""
        return tuple(self.vocabulary.types) or (NOBODY_KNOWN,)

    @cached_property
    def identifiers(self) -> dict[str, str]:
        """The field for each name."""
        identifiers = Identifiers()
        return {item.name: identifiers.of(item.name) for item in self.read}

    @cached_property
    def constants(self) -> dict[tuple[str, str], str]:
        """The constants for types, for rules, and for values (by the name of their enumeration)."""
        identifiers = Identifiers(_OWN_CONSTANTS)
        names_of = {}
        for kind, names in ((TYPE, self.types), (RULE, self.rules)):
            names_of.update({(kind, x): identifiers.of(kind, x, upper=True) for x in names})
        for item in self.enumerations():
            for value in item.values:
                names_of[item.name, value] = identifiers.of(item.name, value, upper=True)
        return names_of

    def about(self, n_objects: int) -> Iterable[Declaration]:
        """The names about this number of objects; 2 means two or more."""
        return (item for item in self.read if min(len(item.parameters), 2) == n_objects)

    def enumerations(self) -> Iterator[Enumeration]:
        """The enumerations among the names."""
        return (item for item in self.read if isinstance(item, Enumeration))

    def numbered(self, kind: str, names: Sequence[str]) -> list[tuple[str, int]]:
        """The constants for all names of a kind, as in ``constants``, with their numbers."""
        return [(self.constants[kind, name], number) for number, name in enumerate(names)]

    def values_of(self, name: str) -> tuple[str, ...]:
        """The values of an enumeration."""
        declaration = self.vocabulary.declarations[name]
        assert isinstance(declaration, Enumeration)
        return declaration.values

    def expression(self, name: str, places: Sequence[str]) -> str:
        """The expression for the input's value for the objects at these places."""
        field = self.identifiers[name]
        if not places:
            return f"in->{field}"
        if len(places) == 1:
            return f"in->objects[{places[0]}].{field}"
        return f"rulec_of_{field}(in, {', '.join(places)})"


def input_fields(rulebook: CompiledRulebook) -> InputFields:
    """The fields that the rules of a rulebook read. Raises RulecError R0750."""
    names = set[str]()
    for rule in rulebook.rules:
        for read in rule.machine.reads:
            if isinstance(read, Read):
                names.add(read.name)
            else:
                names.update(name for _, term in read.terms for name in names_in(term))
    vocabulary = rulebook.vocabulary
    fields = tuple([item for name, item in vocabulary.declarations.items() if name in names])
    for item in fields:
        if isinstance(item, Enumeration) and len(item.values) > MOST_VALUES:
            raise too_large(f"`{item.name}` has {len(item.values)} values, at most {MOST_VALUES}")
    if len(vocabulary.types) > MOST_VALUES:
        raise too_large(f"there are {len(vocabulary.types)} types, at most {MOST_VALUES}")
    return InputFields(vocabulary, fields, tuple([rule.name for rule in rulebook.rules]))


@dataclass(frozen=True, slots=True)
class FieldSpelling:
    """The types of a language's fields, its constants for unknown values, and its literals."""

    byte: str
    number: str
    unknown: str
    unknown_number: str
    of_whole: Callable[[int], str] = field(default=str, kw_only=True)
    of_decimal: Callable[[float], str] = field(default=repr, kw_only=True)

    def kind(self, item: Declaration) -> str:
        """The type of a name's field."""
        return self.number if isinstance(item, Quantity) else self.byte

    def initial(self, item: Declaration, *, defaults: bool = True) -> str:
        """The initial value of a field: the default of its name, or else unknown."""
        default = default_of(item) if defaults else None
        if isinstance(item, Quantity):
            known = isinstance(default, int | float) and isfinite(default)
            return self.of_decimal(float(default or 0)) if known else self.unknown_number
        if default is None:
            return self.unknown
        if isinstance(item, Enumeration):
            return self.of_whole(item.values.index(str(default)))
        return self.of_whole(int(bool(default)))


def default_of(item: Declaration) -> bool | float | str | None:
    """The default of a name if the state does not give its value; None if there is none."""
    default = item.default
    return None if type(default) in UNKNOWN_TYPES else default


def meaning(item: Declaration) -> str:
    """What the values of a name are: about which objects, of which kind or unit, by default."""
    match item:
        case Signal():
            kind = "signal"
        case Enumeration():
            kind = f"one of {len(item.values)} values"
        case Quantity():
            kind = f"in {item.unit}"
    of = f" of each {item.parameters[0]}" if item.parameters else ""
    default = "" if default_of(item) is None else f", default {default_of(item)}".lower()
    return f"{of}: {kind}{default}"
