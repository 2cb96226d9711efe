"""Elements of a file as trees, whatever the encoding."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import LARGEST, number_in, short

MOST_ELEMENTS = 1_000_000
"""Limit on the elements in one child of the root, about 300 MB of memory."""

LONGEST_TEXT = 1_000
"""The number of characters kept of an element's text; numbers and words are shorter."""

LONGEST_ID = 18
"""Limit on the digits of an id."""

SMALLEST = 1e-100
"""Numbers closer to 0 than this are read as 0: geometry would square them and divide by 0."""


@dataclass(slots=True)
class Tree:
    """An element with its text and children. Its methods raise RulecError R0610.

    ``place`` is the line or byte where it begins, depending on the format.
    """

    # Not frozen: a recording has millions, whose text and children are added later
    name: str
    attributes: dict[str, str]
    place: int
    path: Path
    form: FileFormat
    text: str = ""
    children: list[Tree] = field(default_factory=list)

    def first(self, name: str) -> Tree | None:
        """The first child with a name."""
        for child in self.children:
            if child.name == name:
                return child
        return None

    def child(self, name: str) -> Tree:
        """The first child with a name, which must exist."""
        tree = self.first(name)
        if tree is None:
            raise self.wrong(f"the element `{self.name}` has no `{name}`")
        return tree

    def all(self, name: str) -> list[Tree]:
        """All children with a name."""
        return [child for child in self.children if child.name == name]

    def attribute(self, key: str) -> str:
        """An attribute's text, which must exist."""
        value = self.attributes.get(key)
        if value is None:
            raise self.wrong(f"the element `{self.name}` has no `{key}`")
        return value

    def filled(self, key: str) -> str:
        """An attribute's text, which must be neither missing nor empty."""
        if not self.get(key):
            raise self.wrong(f"the element `{self.name}` has no `{key}`")
        return self.attributes[key]

    def get(self, key: str) -> str:
        """An attribute's text; empty if it is missing."""
        return self.attributes.get(key, "")

    def id(self, key: str = "id") -> str:
        """The whole number in an attribute, without leading zeros."""
        text = self.attribute(key).strip()
        if not (text.isascii() and text.isdigit() and len(text) <= LONGEST_ID):
            why = f"`{key}` of a `{self.name}` is `{short(text)}`"
            raise self.wrong(why, f"a whole number of at most {LONGEST_ID} digits")
        return str(int(text))

    def ids(self, name: str) -> tuple[str, ...]:
        """The ids that all children with a name refer to."""
        return tuple([child.id("ref") for child in self.children if child.name == name])

    def number(self, key: str = "", default: float | None = None) -> float:
        """The number in the text or, with ``key``, in an attribute; its default if missing."""
        if default is not None and key not in self.attributes:
            return default
        return self.as_number(key, self.attribute(key) if key else self.text)

    def as_number(self, key: str, text: str) -> float:
        """The number in a text, which must not be huge."""
        try:
            value = number_in(text)
        except ValueError:
            value = LARGEST
        if not abs(value) < LARGEST or len(text) == LONGEST_TEXT:
            raise self.wrong(self._quoted(text, key), f"a number below {LARGEST:.0e}")
        return value if abs(value) > SMALLEST else 0.0

    def positive(self, key: str, default: float | None = None) -> float:
        """A number above 0 in an attribute; its default if missing."""
        value = self.number(key, default)
        if value <= 0:
            raise self.wrong(f"`{key}` of a `{self.name}` is {value:g}", "a number above 0")
        return value

    def whole(self) -> int:
        """The whole number in the text, which must not be huge."""
        try:
            number_in(self.text)
            value = int(self.text)
        except ValueError:
            value = int(LARGEST)
        if not abs(value) < LARGEST or len(self.text) == LONGEST_TEXT:
            raise self.wrong(self._quoted(self.text), f"a whole number below {LARGEST:.0e}")
        return value

    def one_of(self, words: Collection[str]) -> str:
        """The text, which must be one of ``words``."""
        if self.word not in words:
            raise self.wrong(self._quoted(self.text), f"one of {', '.join(sorted(words))}")
        return self.word

    @property
    def word(self) -> str:
        """The text without surrounding blanks."""
        return self.text.strip()

    def wrong(self, why: str, expected: str = "") -> RulecError:
        """The error (R0610) at the place where the element begins."""
        expected = expected and f"expected {expected}"
        return self.form.refused(self.path, why, self.place, expected=expected)

    def _quoted(self, text: str, key: str = "") -> str:
        what = f"`{key}` of a `{self.name}`" if key else f"`{self.name}`"
        return f"{what} is `{short(text.strip())}`" if text.strip() else f"{what} is empty"
