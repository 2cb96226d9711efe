"""Assumptions and thresholds from texts of the command line."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import fields, replace
from fractions import Fraction
from math import isfinite

from rulec.diagnostics import did_you_mean, named
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.trace import Value
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary
from rulec.vocabulary.units import parse_unit

_NUMBER = re.compile(r"(-?[0-9]{1,15}(?:\.[0-9]{1,15})?)\s*(\S*)")


def assumption_options(texts: Iterable[str], vocabulary: Vocabulary) -> dict[str, Value]:
    """Name -> value, from texts such as ``built_up=true`` and ``limit=30 mph``.

    Raises:
        ValueError: with what is wrong, for people.
    """
    values: dict[str, Value] = {}
    for text in texts:
        name, value = _pair(text, "built_up=true")
        declaration = vocabulary.declarations.get(name)
        known = [
            declared.name
            for declared in vocabulary.declarations.values()
            if not declared.parameters
        ]
        if declaration is None:
            hint = did_you_mean(name, known)
            message = f"vocabulary `{vocabulary.name}` has no `{name}`"
            raise ValueError(f"{message}; {hint}" if hint else message)
        if declaration.parameters:
            raise ValueError(f"`{name}` is about objects; only what is about none can be assumed")
        values[name] = _value(value, declaration)
    return values


def _pair(text: str, example: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise ValueError(f"`{text}` is not written as in `{example}`")
    return name.strip(), value.strip()


def _value(text: str, declaration: Declaration) -> Value:
    match declaration:
        case Signal(name):
            if text not in ("true", "false"):
                raise ValueError(f"`{name}` is `true` or `false`, not `{text}`")
            return text == "true"
        case Enumeration(name, _, values):
            if text not in values:
                hint = did_you_mean(text, values)
                message = f"`{name}` is one of {named(values)}, not `{text}`"
                raise ValueError(f"{message}; {hint}" if hint else message)
            return text
        case Quantity(name, _, unit):
            return _measure(text, name, unit)


def _measure(text: str, name: str, unit: str) -> float:
    """A number in its unit or in another one.

    A bare number is in its own unit.
    """
    match = _NUMBER.fullmatch(text)
    own = parse_unit(unit)
    given = own if match is None or not match[2] else parse_unit(match[2])
    if match is None or own is None or given is None or given.dimension != own.dimension:
        example = f"50 {unit}" if unit else "50"
        raise ValueError(f"`{name}` is a number such as `{example}`, not `{text}`")
    return float(Fraction(match[1]) * given.factor / own.factor)


def threshold_options(texts: Iterable[str]) -> Thresholds:
    """The usual thresholds but for some, from texts such as ``near_m=200``.

    Raises:
        ValueError: with what is wrong, for people.
    """
    known = {field.name: field.default for field in fields(Thresholds)}
    numbers: dict[str, float | int] = {}
    for text in texts:
        name, value = _pair(text, "near_m=200")
        if name not in known:
            hint = did_you_mean(name, list(known))
            message = f"there is no threshold `{name}`"
            raise ValueError(
                f"{message}; {hint}" if hint else f"{message} among {named(list(known))}"
            )
        try:
            number = float(value)
        except ValueError:
            number = -1.0
        if not isfinite(number) or number < 0:
            raise ValueError(f"`{name}` is a number from 0 on, not `{value}`")
        if isinstance(known[name], int) and number != int(number):
            raise ValueError(f"`{name}` is a whole number, not `{value}`")
        numbers[name] = int(number) if isinstance(known[name], int) else number
    return replace(Thresholds(), **numbers)  # type: ignore[arg-type]
