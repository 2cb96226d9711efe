"""Formats of XML files, and XML elements with checked attributes."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from xml.parsers.expat import XMLParserType

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import FileFormat

LARGEST = 1e8
"""Limit on numbers in a file, coordinates (m) included: larger than the earth's circumference."""


@dataclass(slots=True)
class XmlElement:
    """An element of a file while it is read. Its methods raise RulecError R0610."""

    # Not frozen: one serves for all elements of a file, one after the other
    name: str
    attributes: dict[str, str]
    parser: XMLParserType
    path: Path
    form: FileFormat

    def get(self, key: str) -> str:
        """An attribute's text; empty if it is missing."""
        return self.attributes.get(key, "")

    def text(self, key: str) -> str:
        """An attribute's text, which must be neither missing nor empty."""
        value = self.attributes.get(key)
        if not value:
            raise self.wrong(f"a `{self.name}` has no `{key}`")
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """The number in an attribute; its default if missing."""
        if default is not None and key not in self.attributes:
            return default
        return self.as_number(key, self.text(key))

    def positive(self, key: str, default: float | None = None) -> float:
        """A number above 0."""
        value = self.number(key, default)
        if value <= 0:
            raise self.wrong(f"`{key}` of a `{self.name}` is {value:g}", "a number above 0")
        return value

    def as_number(self, key: str, text: str) -> float:
        """The number in a text, which must not be huge."""
        try:
            value = number_in(text)
        except ValueError:
            value = LARGEST
        if not abs(value) < LARGEST:
            expected = f"a number below {LARGEST:.0e}"
            raise self.wrong(f"`{key}` of a `{self.name}` is `{short(text)}`", expected)
        return value

    def wrong(self, why: str, expected: str = "") -> RulecError:
        """The error (R0610) at the parser's current position."""
        expected = expected and f"expected {expected}"
        return self.form.refused(self.path, why, self.parser.CurrentLineNumber, expected=expected)


def number_in(text: str) -> float:
    """The number in a text. Raises ValueError.

    Python would also read ``1_0`` and the digits of other scripts, which no format has: whatever
    wrote them meant something else.
    """
    if "_" in text or not text.strip().isascii():
        raise ValueError(text)
    return float(text)


def numbers_in(texts: Collection[str]) -> list[float]:
    """The numbers in texts, checked together. Raises ValueError as ``number_in`` does."""
    whole = "".join(texts)
    is_plain = whole.isascii() and "_" not in whole
    return list(map(float if is_plain else number_in, texts))


def short(text: str) -> str:
    """Text of a file for use in a message: short, and without control characters."""
    return "".join(c if c.isprintable() else "?" for c in text[:40])
