"""Do objects and states fit a vocabulary? Without a full answer there is no verdict."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rulec.diagnostics import SourceLocation, did_you_mean, named
from rulec.monitoring.monitoring_messages import UNDECLARED_NAME, UNFITTING_VALUE
from rulec.trace import State
from rulec.trace.trace_messages import UNKNOWN_OBJECT
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary


def check_objects(
    objects: Mapping[str, str], vocabulary: Vocabulary, place: SourceLocation | None = None
) -> None:
    """Every object is of a type that the vocabulary knows. Raises RulecError R0505."""
    for name, kind in objects.items():
        if kind not in vocabulary.types:
            raise UNKNOWN_OBJECT.error(
                place,
                f"object `{name}` is of type `{kind}`, which vocabulary "
                f"`{vocabulary.name}` does not know",
                help=_suggest(kind, vocabulary.types),
            )


def check_state(
    state: State,
    objects: Mapping[str, str],
    vocabulary: Vocabulary,
    where: str,
    place: SourceLocation | None = None,
) -> None:
    """Every name and value of a state fits its declaration. Raises RulecError R0502, R0503, R0505.

    ``where`` names the state in messages.
    """
    for name, value in state.items():
        declaration = vocabulary.declarations.get(name)
        if declaration is None:
            raise UNDECLARED_NAME.error(
                place,
                f"{where} speaks of `{name}`, which vocabulary `{vocabulary.name}` does not know",
                help=_unknown_name(name, vocabulary),
            )
        _check_value(value, declaration, declaration.parameters, objects, vocabulary, where, place)


def _check_value(
    value: Any,
    declaration: Declaration,
    parameters: Sequence[str],
    objects: Mapping[str, str],
    vocabulary: Vocabulary,
    where: str,
    place: SourceLocation | None,
) -> None:
    name = declaration.name
    if not parameters:
        if not _fits(value, declaration):
            message = f"{where} says `{name}` is {_shown(value)}; {_wanted(declaration)}"
            raise UNFITTING_VALUE.error(place, message, help=_nearest_value(value, declaration))
        return
    # Asking for a mapping takes far longer than asking for a dictionary.
    if type(value) is not dict and not isinstance(value, Mapping):
        message = f"{where} gives `{name}` one value; it is about each `{parameters[0]}`"
        way_out = f'write {{"{name}": {{"OBJECT": VALUE}}}}'
        raise UNFITTING_VALUE.error(place, message, help=way_out)
    for item, inner in value.items():
        if item not in objects:
            message = f"{where} gives `{name}` for `{item}`, which is not among the objects"
            raise UNKNOWN_OBJECT.error(place, message, help=_suggest(item, objects))
        if not vocabulary.is_subtype(objects[item], parameters[0]):
            message = (
                f"{where} gives `{name}` for `{item}`, which is of type `{objects[item]}`; "
                f"`{name}` is about each `{parameters[0]}`"
            )
            raise UNKNOWN_OBJECT.error(place, message)
        _check_value(inner, declaration, parameters[1:], objects, vocabulary, where, place)


def _fits(value: Any, declaration: Declaration) -> bool:
    match declaration:
        case Enumeration():
            return isinstance(value, str) and value in declaration.values
        case Signal():
            return isinstance(value, bool)
        case Quantity():
            number = isinstance(value, int | float) and not isinstance(value, bool)
            # Neither infinite nor nan; whole numbers may be larger than any float.
            return number and -math.inf < value < math.inf


def _wanted(declaration: Declaration) -> str:
    match declaration:
        case Enumeration():
            return f"it is one of {named(declaration.values)}"
        case Signal():
            return "it is true or false"
        case Quantity():
            return f"it is a finite number, in {declaration.unit}"


def _nearest_value(value: Any, declaration: Declaration) -> str:
    if isinstance(declaration, Enumeration) and isinstance(value, str):
        return _suggest(value, declaration.values)
    return ""


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return "given per object"
    if isinstance(value, str):
        text = json.dumps(value, ensure_ascii=False)
    elif isinstance(value, float):
        text = f"{value:g}"
    elif isinstance(value, int):
        # Python refuses to write out whole numbers of many thousand digits.
        text = str(value) if value.bit_length() < 200 else "a number of many digits"
    else:
        text = f"{value} ({type(value).__name__})"
    return f"`{text[:60]}…`" if len(text) > 60 else f"`{text}`"


def _suggest(name: str, known: Iterable[str]) -> str:
    # A key that Python code has made may be no text: an object's number, say.
    known = [str(one) for one in known]
    return did_you_mean(str(name), known) or (f"known: {named(known)}" if known else "")


def _unknown_name(name: str, vocabulary: Vocabulary) -> str:
    enumeration = vocabulary.enumeration_of.get(name)
    if enumeration is not None:
        return f'`{name}` is a value: write {{"{enumeration.name}": … "{name}"}}'
    return _suggest(name, vocabulary.declarations)
