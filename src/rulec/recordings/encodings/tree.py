"""Elements of a file as trees, whatever form they are written in."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.xml_element import LARGEST, short

MOST_ELEMENTS = 1_000_000
"""In one child of the root, some 300 MB of memory."""

LONGEST_TEXT = 1_000
"""Characters that are kept of an element's text; numbers and words are shorter."""

LONGEST_ID = 18
"""Digits."""

SMALLEST = 1e-100
"""Numbers closer to 0 are 0: geometry squares what it divides by, which then is none."""


Texts = tuple[bytes, ...]


@dataclass(frozen=True, slots=True)
class AlikeElements:
    """Elements one after the other that hold the same ones: how many, and what they say.

    ``columns``: for each of the elements in them that somebody wants, its text in all of them.
    """

    count: int
    columns: tuple[Texts, ...]


@dataclass(slots=True)
class Tree:
    """An element with its text, and those in it. Its methods raise RulecError R0610.

    ``place`` is the line or byte that it begins in, as its format counts; ``alike`` are children
    that no trees have been made of, since there are very many.
    """

    # Not frozen: a recording has millions, whose text and children come later
    name: str
    attributes: dict[str, str]
    place: int
    path: Path
    form: FileFormat
    text: str = ""
    children: list[Tree] = field(default_factory=list)
    alike: AlikeElements | None = None

    def first(self, name: str) -> Tree | None:
        """The first child of a name."""
        for child in self.children:
            if child.name == name:
                return child
        return None

    def child(self, name: str) -> Tree:
        """The first child of a name, which must be there."""
        tree = self.first(name)
        if tree is None:
            raise self.wrong(f"the element `{self.name}` has no `{name}`")
        return tree

    def all(self, name: str) -> list[Tree]:
        """All children of a name."""
        return [child for child in self.children if child.name == name]

    def attribute(self, key: str) -> str:
        """An attribute's text, which must be there."""
        value = self.attributes.get(key)
        if value is None:
            raise self.wrong(f"the element `{self.name}` has no `{key}`")
        return value

    def id(self, key: str = "id") -> str:
        """The whole number in an attribute, without leading zeros."""
        text = self.attribute(key).strip()
        if not (text.isascii() and text.isdigit() and len(text) <= LONGEST_ID):
            why = f"`{key}` of a `{self.name}` is `{short(text)}`"
            raise self.wrong(why, f"a whole number of at most {LONGEST_ID} digits")
        return str(int(text))

    def ids(self, name: str) -> tuple[str, ...]:
        """What all children of a name refer to."""
        return tuple([child.id("ref") for child in self.children if child.name == name])

    def number(self, key: str = "") -> float:
        """The number that the text spells, or an attribute; it must not be huge."""
        text = self.attribute(key) if key else self.text
        try:
            value = float(text)
        except ValueError:
            value = LARGEST
        if not abs(value) < LARGEST or len(text) == LONGEST_TEXT:
            raise self.wrong(_quoted(key or self.name, text), f"a number below {LARGEST:.0e}")
        return value if abs(value) > SMALLEST else 0.0

    def whole(self) -> int:
        """The whole number that the text spells, which must not be huge."""
        try:
            value = int(self.text)
        except ValueError:
            value = int(LARGEST)
        if not abs(value) < LARGEST or len(self.text) == LONGEST_TEXT:
            raise self.wrong(_quoted(self.name, self.text), f"a whole number below {LARGEST:.0e}")
        return value

    def one_of(self, words: Collection[str]) -> str:
        """The text, which must be one of some words."""
        if self.word not in words:
            raise self.wrong(_quoted(self.name, self.text), f"one of {', '.join(sorted(words))}")
        return self.word

    @property
    def word(self) -> str:
        """The text without blanks around it."""
        return self.text.strip()

    def wrong(self, why: str, expected: str = "") -> RulecError:
        """The error (R0610) for where the element begins."""
        expected = expected and f"expected {expected}"
        return self.form.refused(self.path, why, self.place, expected=expected)


def _quoted(name: str, text: str) -> str:
    return f"`{name}` is `{short(text.strip())}`" if text.strip() else f"`{name}` is empty"
