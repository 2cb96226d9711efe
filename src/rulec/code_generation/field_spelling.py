"""How the fields of an input are declared, initialised and explained in a language."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import isfinite

from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal
from rulec.vocabulary.partial_values import UNKNOWN_TYPES


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
