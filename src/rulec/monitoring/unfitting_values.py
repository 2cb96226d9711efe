"""What is wrong with values and names of states, and what to write instead, in words."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rulec.diagnostics import did_you_mean, named
from rulec.rulebook.vocabulary_phrases import synonyms_of_the_field
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval, OneOf

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


def misfit(value: Any, declaration: Declaration) -> str:
    """What a value should be that does not fit its declaration; empty if it fits."""
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


def way_out_of(value: Any, declaration: Declaration) -> str:
    """What to write in place of a value that does not fit; empty if nothing comes to mind."""
    match declaration:
        case Enumeration() if isinstance(value, str):
            return _SIDES.get(value) or _meant(value, declaration.values)
        case Signal() if isinstance(value, str | int | float):
            return _TRUTHS_ELSEWHERE.get(value, "")
        case Quantity() if isinstance(value, str) and _is_number(value):
            return "numbers are written without quotes"
        case Quantity() if isinstance(value, str) and _is_number(value.partition(" ")[0]):
            return "write the number alone, in that unit"
    return _of_python(value)


def _of_python(value: Any) -> str:
    """Advice about a value that only a program can give, not a file."""
    if value is None:
        return "what is not known is `rulec.UNKNOWN`; what has its default is left out"
    if type(value).__module__ == "numpy":
        return "`.item()` makes a value of Python's of one of numpy's"
    return ""


def shown(value: Any) -> str:
    """A value as messages quote it, shortened if it is long."""
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


def suggested(name: str, known: Iterable[str]) -> str:
    """The known name that may be meant, or else those that there are."""
    # A key that Python code has made may be no text: an object's number, say.
    known = [str(name) for name in known]
    return did_you_mean(str(name), known) or (f"known: {named(known)}" if known else "")


def similar_type(kind: str, types: Iterable[str]) -> str:
    """The type that a word of other tools means, such as a data set's; empty if none."""
    others = synonyms_of_the_field()
    plain = kind.casefold()
    similar = (name for name in types if plain in others.get(name, ()))
    return next((f"did you mean `{name}`?" for name in similar), "")


def way_out_of_name(name: str, vocabulary: Vocabulary, known: Iterable[str]) -> str:
    """What to write in place of a name that the vocabulary does not know."""
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
    return _meant(str(name), known) or suggested(name, known)


def _meant(name: str, known: Sequence[str]) -> str:
    # Phrases and synonyms are read from files: only for this message.
    from rulec.rulebook.names.word_meanings import suggestion

    return suggestion(name, known)
