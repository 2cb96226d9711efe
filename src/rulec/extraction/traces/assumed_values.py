"""Values to assume, from texts such as ``built_up=true`` and ``limit=30 mph``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from fractions import Fraction

from rulec.diagnostics import named
from rulec.extraction.traffic_thresholds import hinted, pair_of
from rulec.rulebook.names.word_meanings import suggestion
from rulec.trace import Value
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary
from rulec.vocabulary.units import parse_unit

_NUMBER = re.compile(r"(-?[0-9]{1,15}(?:\.[0-9]{1,15})?)\s*(\S*)")


def assumption_options(texts: Iterable[str], vocabulary: Vocabulary) -> dict[str, Value]:
    """Name -> value, from texts such as ``built_up=true`` and ``limit=30 mph``.

    Raises ValueError with a message for users.
    """
    values: dict[str, Value] = {}
    for text in texts:
        name, value = pair_of(text, "built_up=true")
        declaration = vocabulary.declarations.get(name)
        if declaration is None:
            known = [x.name for x in vocabulary.declarations.values() if not x.parameters]
            message = f"`{vocabulary.name}` does not know `{name}`"
            hint = suggestion(name, known)
            raise ValueError(f"{message}; {hint}" if hint else message)
        if declaration.parameters:
            raise ValueError(f"`{name}` is about objects; assume only words that are not")
        values[name] = _value(value, declaration)
    return values


def _value(text: str, declaration: Declaration) -> Value:
    match declaration:
        case Signal(name):
            if text not in ("true", "false"):
                raise ValueError(f"`{name}` is `true` or `false`, not `{text}`")
            return text == "true"
        case Enumeration(name, _, values):
            if text not in values:
                message = f"`{name}` is one of {named(values)}, not `{text}`"
                raise ValueError(hinted(message, text, values))
            return text
        case Quantity(name, _, unit):
            return _measure(text, name, unit)


def _measure(text: str, name: str, unit: str) -> float:
    """A number in its own unit, converted from any unit of its dimension; 0 needs no unit."""
    match = _NUMBER.fullmatch(text)
    own = parse_unit(unit)
    given = own if match is None or not match[2] else parse_unit(match[2])
    if match is not None and not match[2] and unit and Fraction(match[1]):
        raise ValueError(f"`{name}` is in {unit}: write the unit, such as `{name}={text} {unit}`")
    if match is None or own is None or given is None or given.dimension != own.dimension:
        example = f"50 {unit}" if unit else "50"
        raise ValueError(f"`{name}` is a number such as `{example}`, not `{text}`")
    return float(Fraction(match[1]) * given.factor / own.factor)
