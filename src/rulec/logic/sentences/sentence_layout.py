"""A sentence with its nested lists, labelled (a), (b); (i), (ii); (1), (2) by level."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.language import Language
from rulec.logic.sentences.sentence import Phrase, label

_ROMAN = ((50, "l"), (40, "xl"), (10, "x"), (9, "ix"), (5, "v"), (4, "iv"), (1, "i"))


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a sentence, nested ``depth`` lists deep. The first one has no label."""

    depth: int
    label: str
    text: str


def lines(phrase: Phrase, language: Language = ENGLISH) -> list[Line]:
    """The sentence's lines, with an initial capital letter and a final full stop."""
    result = list(_lines(phrase, (0, ""), ".", language.semicolon))
    first = result[0]
    return [Line(0, "", f"{first.text[:1].upper()}{first.text[1:]}"), *result[1:]]


def in_one_line(phrase: Phrase, language: Language = ENGLISH) -> str:
    """The sentence as one line of text, including labels."""
    return " ".join(f"{line.label} {line.text}".strip() for line in lines(phrase, language))


def _lines(phrase: Phrase, place: tuple[int, str], end: str, semicolon: str) -> Iterator[Line]:
    depth, own = place
    labels = [_label(depth, index, own) for index in range(len(phrase.items))]
    text = phrase.text
    for index, label_ in enumerate(labels):
        text = text.replace(label(index), label_)
    yield Line(depth, own, text if phrase.items else f"{text}{end}")
    for index, (label_of_item, item) in enumerate(zip(labels, phrase.items, strict=True)):
        left = len(labels) - index - 1
        joint = f" {phrase.joint}" if left == 1 and phrase.joint else ""
        after = f"{semicolon}{joint}" if left else end
        yield from _lines(item, (depth + 1, label_of_item), after, semicolon)


def _label(depth: int, index: int, above: str) -> str:
    match depth:
        case 0:
            return f"({_letters(index)})"
        case 1:
            return f"({_roman(index + 1)})"
        case 2:
            return f"({index + 1})"
        case _:
            return f"({above.strip('()')}.{index + 1})"


def _letters(index: int) -> str:
    more, last = divmod(index, 26)
    return (_letters(more - 1) if more else "") + chr(ord("a") + last)


def _roman(number: int) -> str:
    text = ""
    for value, sign in _ROMAN:
        times, number = divmod(number, value)
        text += sign * times
    return text
