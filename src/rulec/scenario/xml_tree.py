"""The children of an XML file's root as trees, one after the other.

Only one of them is in memory at a time, so a file may be larger than that.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.scenario.safe_xml import scan
from rulec.scenario.xml_element import LARGEST, XmlElement, XmlFormat, short

MOST_ELEMENTS = 1_000_000
"""In one child of the root, some 300 MB of memory."""

LONGEST_TEXT = 1_000
"""Characters that are kept of an element's text; numbers and words are shorter."""

LONGEST_ID = 18
"""Digits."""

SMALLEST = 1e-100
"""Numbers closer to 0 are 0: geometry squares what it divides by, which then is none."""


@dataclass(slots=True)
class XmlTree:
    """An element with its text, and those in it. Its methods raise RulecError R0610."""

    # Not frozen: a recording has millions, whose text and children come later
    name: str
    attributes: Mapping[str, str]
    line: int
    path: Path
    form: XmlFormat
    text: str = ""
    children: list[XmlTree] = field(default_factory=list)

    def first(self, name: str) -> XmlTree | None:
        """The first child of a name."""
        for child in self.children:
            if child.name == name:
                return child
        return None

    def child(self, name: str) -> XmlTree:
        """The first child of a name, which must be there."""
        found = self.first(name)
        if found is None:
            raise self.wrong(f"the element `{self.name}` has no `{name}`")
        return found

    def all(self, name: str) -> list[XmlTree]:
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
            raise self.wrong(_said(key or self.name, text), f"a number below {LARGEST:.0e}")
        return value if abs(value) > SMALLEST else 0.0

    def whole(self) -> int:
        """The whole number that the text spells, which must not be huge."""
        try:
            value = int(self.text)
        except ValueError:
            value = int(LARGEST)
        if not abs(value) < LARGEST or len(self.text) == LONGEST_TEXT:
            raise self.wrong(_said(self.name, self.text), f"a whole number below {LARGEST:.0e}")
        return value

    def one_of(self, words: Collection[str]) -> str:
        """The text, which must be one of some words."""
        if self.word not in words:
            raise self.wrong(_said(self.name, self.text), f"one of {', '.join(sorted(words))}")
        return self.word

    @property
    def word(self) -> str:
        """The text without blanks around it."""
        return self.text.strip()

    def wrong(self, why: str, expected: str = "") -> RulecError:
        """The error (R0610) for the line that the element begins in."""
        expected = expected and f"expected {expected}"
        return self.form.refused(self.path, why, self.line, expected=expected)


def _said(name: str, text: str) -> str:
    return f"`{name}` is `{short(text.strip())}`" if text.strip() else f"`{name}` is empty"


def scan_trees(
    path: Path,
    form: XmlFormat,
    root: Callable[[XmlTree], None],
    child: Callable[[XmlTree], None],
) -> None:
    """Scan an XML file once; callbacks get the root, without children, and each of its children.

    Raises RulecError R0610 for a file that is none, R0701 for one that cannot be read.
    """
    # The elements that have begun
    open_trees: list[XmlTree] = []
    count = 0

    def begin(element: XmlElement) -> None:
        nonlocal count
        line = element.parser.CurrentLineNumber
        tree = XmlTree(element.name, element.attributes, line, path, form)
        count += 1
        if len(open_trees) > 1:
            open_trees[-1].children.append(tree)
            if count > MOST_ELEMENTS:
                whole = open_trees[1]
                most = f"more than {MOST_ELEMENTS:,} others in it"
                raise whole.wrong(f"the element `{short(whole.name)}` has {most}")
        elif open_trees:
            count = 0
        else:
            root(tree)
        open_trees.append(tree)

    def end(_: str) -> None:
        tree = open_trees.pop()
        if len(open_trees) == 1:
            child(tree)

    def text(words: str) -> None:
        tree = open_trees[-1]
        if not words.isspace() and len(tree.text) < LONGEST_TEXT:
            tree.text = (tree.text + words)[:LONGEST_TEXT]

    scan(path, form, begin, end=end, text=text)
