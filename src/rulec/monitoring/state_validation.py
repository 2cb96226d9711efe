"""Validation of objects and states against a vocabulary.

Incomplete or invalid states get no verdict. ``StateValidator`` first does a quick check; states
that fail it go to ``check_state``, which knows the rare types and reports what is wrong.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

from rulec.diagnostics import SourceLocation, did_you_mean, named
from rulec.monitoring.monitoring_messages import UNDECLARED_NAME, UNFITTING_VALUE
from rulec.resource_limits import OBJECTS
from rulec.trace import State
from rulec.trace.trace_messages import UNKNOWN_OBJECT
from rulec.value_display import brief
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, Interval, OneOf, UnknownValue

NUMBERS = frozenset({int, float})
TRUTHS = frozenset({bool})
"""The plain types of signals; checking others, such as a library's types, takes longer."""

_PLAIN = NUMBERS | TRUTHS | {str}

_Look: TypeAlias = Callable[[Any], bool]


class StateValidator:
    """A validator of states with these objects, whose types are known."""

    def __init__(self, vocabulary: Vocabulary, objects: Mapping[str, str]) -> None:
        self._vocabulary = vocabulary
        self._objects = objects
        self._looks = _Looks(vocabulary, objects)
        self._partial_looks = _Looks(vocabulary, objects, partial=True)

    def check(
        self,
        states: Iterable[State],
        where: Callable[[int], str],
        place: SourceLocation | None = None,
    ) -> bool:
        """Check each state as ``check_state`` does; ``where`` names it by its number.

        Returns whether some value is only partly known.
        """
        looks = self._looks
        for number, state in enumerate(states):
            if _passes(state, looks):
                continue
            # If something is unknown in one state, it usually is in the others, too.
            if looks is self._looks and _passes(state, self._partial_looks):
                looks = self._partial_looks
                continue
            check_state(state, self._objects, self._vocabulary, where(number), place)
            if has_partial_values(state):
                looks = self._partial_looks
        return looks is self._partial_looks


class _Looks(dict[str, _Look]):
    """Quick checks of values by name, compiled on first use; ``partial`` values may be allowed."""

    def __init__(
        self, vocabulary: Vocabulary, objects: Mapping[str, str], *, partial: bool = False
    ) -> None:
        self._vocabulary = vocabulary
        self._objects = objects
        self._partial = partial

    def __missing__(self, name: str) -> _Look:
        vocabulary = self._vocabulary
        declaration = vocabulary.declarations[name]
        fitting = [
            frozenset(
                item for item, own in self._objects.items() if vocabulary.is_subtype(own, kind)
            )
            for kind in declaration.parameters
        ]
        self[name] = _look(declaration, fitting, partial=self._partial)
        return self[name]


def _passes(state: Any, looks: _Looks) -> bool:
    """Quick check that a state fits; False means that a full check is needed."""
    try:
        if type(state) is not dict:
            return False
        return all([looks[name](value) for name, value in state.items()])  # noqa: C419 - faster
    except (LookupError, TypeError, OverflowError):
        return False


def check_objects(
    objects: Mapping[str, str], vocabulary: Vocabulary, place: SourceLocation | None = None
) -> None:
    """Check that the vocabulary knows all objects' types, and that there are not too many.

    Raises RulecError R0505, R0718.
    """
    OBJECTS.within(len(objects), place)
    for name, kind in objects.items():
        if not isinstance(kind, str) or kind not in vocabulary.types:
            said = kind if isinstance(kind, str) else brief(kind)
            raise UNKNOWN_OBJECT.error(
                place,
                f"object `{name}` is of type `{said}`, which `{vocabulary.name}` does not know",
                help=_similar_type(said, vocabulary.types) or _suggest(said, vocabulary.types),
            )


def check_told(
    told: Iterable[str] | None, vocabulary: Vocabulary, place: SourceLocation | None = None
) -> None:
    """Check that the vocabulary declares all the names, values or types. Raises R0502."""
    declarations, values = vocabulary.declarations, vocabulary.enumeration_of
    for name in told or ():
        if name not in declarations and name not in values and name not in vocabulary.types:
            raise UNDECLARED_NAME.error(
                place,
                f"`told` has `{name}`, which `{vocabulary.name}` does not know",
                help=_unknown_name(name, vocabulary, (*declarations, *values)),
            )


def has_partial_values(state: Mapping[str, Any]) -> bool:
    """Whether a state has values that are unknown, or intervals."""
    for value in state.values():
        kind = type(value)
        if kind in UNKNOWN_TYPES:
            return True
        # Checking whether an object other than a dict is a mapping is slow.
        is_mapping = kind is dict or (kind not in _PLAIN and isinstance(value, Mapping))
        if is_mapping and has_partial_values(value):
            return True
    return False


def partial_names(states: Iterable[Mapping[str, Any]]) -> set[str]:
    """The names with a value, in some state, that is unknown or an interval."""
    names: set[str] = set()
    for state in states:
        for name, value in state.items():
            if name in names:
                continue
            kind = type(value)
            if kind in UNKNOWN_TYPES or (kind not in _PLAIN and has_partial_values({name: value})):
                names.add(name)
    return names


def check_state(
    state: State,
    objects: Mapping[str, str],
    vocabulary: Vocabulary,
    where: str,
    place: SourceLocation | None = None,
) -> None:
    """Check that every name and value of a state fits its declaration.

    ``where`` names the state in messages. Raises RulecError R0502, R0503 or R0505.
    """
    about = _About(objects, vocabulary, where, place)
    for name, value in state.items():
        declaration = vocabulary.declarations.get(name)
        if declaration is None:
            raise UNDECLARED_NAME.error(
                place,
                f"{where} speaks of `{name}`, which `{vocabulary.name}` does not know",
                help=_unknown_name(name, vocabulary, vocabulary.declarations),
            )
        _check_value(value, declaration, declaration.parameters, about)


_TRUTHS_ELSEWHERE: Mapping[str | float, str] = {
    **dict.fromkeys(("True", "TRUE", "true", "T", "yes", 1), "write `true`"),
    **dict.fromkeys(("False", "FALSE", "false", "F", "no", 0), "write `false`"),
}
"""How other programs, such as pandas, write true and false."""


_SIDES = {
    "near_side_of": "write `right_of` where traffic keeps right, and `left_of` where it keeps left",
    "far_side_of": "write `left_of` where traffic keeps right, and `right_of` where it keeps left",
}
"""Sides in the formulas of a rulebook that declares the side of traffic.

Traces use left and right.
"""


class _About(NamedTuple):
    """What values are checked against, and what messages call their state."""

    objects: Mapping[str, str]
    vocabulary: Vocabulary
    where: str
    place: SourceLocation | None


def _check_value(
    value: Any, declaration: Declaration, parameters: Sequence[str], about: _About
) -> None:
    objects, vocabulary, where, place = about
    name = declaration.name
    if not parameters:
        if expected := _misfit(value, declaration):
            way_out = _of_python(value)
            if isinstance(declaration, Enumeration) and isinstance(value, str):
                way_out = _SIDES.get(value) or _meant(value, declaration.values)
            if isinstance(declaration, Signal) and isinstance(value, str | int | float):
                way_out = _TRUTHS_ELSEWHERE.get(value, "")
            if isinstance(declaration, Quantity) and isinstance(value, str):
                if _is_number(value):
                    way_out = "numbers are written without quotes"
                elif _is_number(value.partition(" ")[0]):
                    way_out = "write the number alone, in that unit"
            message = f"{where} says `{name}` is {_shown(value)}; {expected}"
            if isinstance(value, Mapping):
                message = f"{where} gives `{name}` by object; {expected}, and about no object"
                way_out = f'write {{"{name}": VALUE}}'
            raise UNFITTING_VALUE.error(place, message, help=way_out)
        return
    if value is UNKNOWN:
        return  # of all objects
    # Checking for a mapping is far slower than checking for a dict.
    if type(value) is not dict and not isinstance(value, Mapping):
        message = f"{where} gives `{name}` one value; it is about each `{parameters[0]}`"
        way_out = f'write {{"{name}": {{"OBJECT": VALUE}}}}'
        raise UNFITTING_VALUE.error(place, message, help=way_out)
    for item, inner in value.items():
        if item not in objects:
            message = f"{where} gives `{name}` for `{item}`, which is not among the objects"
            way_out = f'objects have types: write "objects": {{"{item}": "{parameters[0]}"}}'
            raise UNKNOWN_OBJECT.error(place, message, help=_suggest(item, objects) or way_out)
        if not vocabulary.is_subtype(objects[item], parameters[0]):
            message = (
                f"{where} gives `{name}` for `{item}`, which is of type `{objects[item]}`; "
                f"`{name}` is about each `{parameters[0]}`"
            )
            raise UNKNOWN_OBJECT.error(place, message)
        _check_value(inner, declaration, parameters[1:], about)


def _of_python(value: Any) -> str:
    """Advice about a value that only a program can give, not a file."""
    if value is None:
        return "what is not known is `rulec.UNKNOWN`; what has its default is left out"
    if type(value).__module__ == "numpy":
        return "`.item()` makes a value of Python's of one of numpy's"
    return ""


def _look(declaration: Declaration, fitting: list[frozenset[str]], *, partial: bool) -> _Look:
    if not fitting:
        return _one_value(declaration, partial=partial)
    objects, *others = fitting
    if others:
        inner = _look(declaration, others, partial=partial)
        return lambda given: (
            type(given) is dict and objects.issuperset(given) and all(map(inner, given.values()))
        )
    values = _many_values(declaration, partial=partial)
    return lambda given: (
        type(given) is dict and objects.issuperset(given) and values(given.values())
    )


def _one_value(declaration: Declaration, *, partial: bool) -> _Look:
    match declaration:
        case Enumeration():
            known = frozenset([*declaration.values, *([UNKNOWN] if partial else [])])
            if not partial:
                return known.__contains__
            return lambda value: value in known or (type(value) is OneOf and value.values <= known)
        case Signal() if partial:
            return lambda value: type(value) is bool or value is UNKNOWN
        case Signal():
            return lambda value: type(value) is bool
        case Quantity() if partial:
            return lambda value: (
                type(value) in UNKNOWN_TYPES or (type(value) in NUMBERS and math.isfinite(value))
            )
        case Quantity():
            return lambda value: type(value) in NUMBERS and math.isfinite(value)


def _unknown_of(declaration: Declaration) -> Iterable[type]:
    """The types whose values always fit a declaration."""
    match declaration:
        case Signal():
            return (bool, UnknownValue)
        case Quantity():
            return UNKNOWN_TYPES
        case Enumeration():
            return (UnknownValue,)


def _many_values(declaration: Declaration, *, partial: bool) -> _Look:
    if partial:
        fits, unknown = _one_value(declaration, partial=True), frozenset(_unknown_of(declaration))
        # Most values are of the same kind
        return lambda values: unknown.issuperset(map(type, values)) or all(map(fits, values))
    match declaration:
        case Enumeration():
            return frozenset(declaration.values).issuperset
        case Signal():
            return lambda values: TRUTHS.issuperset(map(type, values))
        case Quantity():
            return lambda values: (
                NUMBERS.issuperset(map(type, values)) and all(map(math.isfinite, values))
            )


def _misfit(value: Any, declaration: Declaration) -> str:
    if value is UNKNOWN:
        return ""
    match declaration:
        case Enumeration():
            among = value.values if isinstance(value, OneOf) else (value,)
            if not all(isinstance(item, str) and item in declaration.values for item in among):
                return f"it is one of {named(declaration.values)}"
        case Signal():
            if not isinstance(value, bool):
                return "it is true or false"
        case Quantity() if not isinstance(value, Interval):
            number = isinstance(value, int | float) and not isinstance(value, bool)
            # Neither infinite nor nan; whole numbers may be larger than any float.
            if not number or not -math.inf < value < math.inf:
                return f"it is a finite number, in {declaration.unit}"
    return ""


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Interval):
        return f"from {value.low:g} to {value.high:g}"
    if isinstance(value, str):
        text = json.dumps(value, ensure_ascii=False)
    elif isinstance(value, float):
        text = f"{value:g}"
    elif isinstance(value, int):
        # Python refuses to write out whole numbers of many thousand digits.
        text = str(value) if value.bit_length() < 200 else "a number of many digits"
    else:
        kind = type(value)
        of = "" if kind.__module__ == "builtins" else f"{kind.__module__}."
        text = f"{_written(value)} ({of}{kind.__name__})"
    return f"`{text[:60]}…`" if len(text) > 60 else f"`{text}`"


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _written(value: object) -> str:
    try:
        return str(value)
    except RecursionError:  # lists in lists in lists
        return "…"


def _suggest(name: str, known: Iterable[str]) -> str:
    # A key that Python code has made may be no text: an object's number, say.
    known = [str(name) for name in known]
    return did_you_mean(str(name), known) or (f"known: {named(known)}" if known else "")


def _similar_type(kind: str, types: Iterable[str]) -> str:
    # Synonyms are read from a file: only for this message.
    from rulec.rulebook.vocabulary_phrases import synonyms_of_the_field

    others = synonyms_of_the_field()
    plain = kind.casefold()
    similar = (name for name in types if plain in others.get(name, ()))
    return next((f"did you mean `{name}`?" for name in similar), "")


def _unknown_name(name: str, vocabulary: Vocabulary, known: Iterable[str]) -> str:
    enumeration = vocabulary.enumeration_of.get(name)
    if name in _SIDES:
        return f"it is a word of formulas; of `lateral` {_SIDES[name]}"
    if enumeration is not None:
        return f'`{name}` is a value: write {{"{enumeration.name}": … "{name}"}}'
    # Where files are looked for, 3 ms: only for this message.
    from rulec.rulebook.files.words_in_files import vocabularies_with

    if others := vocabularies_with(str(name)):
        return f"it is a word of the vocabulary `{others[0]}`: judge by a rulebook that uses that"
    known = [str(word) for word in known]
    return _meant(str(name), known) or _suggest(name, known)


def _meant(name: str, known: Sequence[str]) -> str:
    # Phrases and synonyms are read from files: only for this message.
    from rulec.rulebook.names.word_meanings import suggestion

    return suggestion(name, known)
