"""The attributes of an XML element as texts and numbers, checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.parsers.expat import XMLParserType

from rulec.diagnostics import RulecError
from rulec.scenario.recorded.recording import FARTHEST_M
from rulec.scenario.safe_xml import XmlFormat, short


@dataclass(frozen=True, slots=True)
class XmlElement:
    """An element of a file that is being read."""

    name: str
    attributes: Mapping[str, str]
    parser: XMLParserType
    path: Path
    form: XmlFormat

    def text(self, key: str) -> str:
        """Raises RulecError R0610 if it is missing, or empty."""
        value = self.attributes.get(key)
        if not value:
            raise self.wrong(f"a `{self.name}` has no `{key}`")
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """The number in an attribute, or its default.

        Raises RulecError R0610 if it is none, or a huge one, or missing without a default.
        """
        if default is not None and key not in self.attributes:
            return default
        return self.as_number(key, self.text(key))

    def positive(self, key: str, default: float | None = None) -> float:
        """A number above 0. Raises RulecError R0610."""
        value = self.number(key, default)
        if value <= 0:
            raise self.wrong(f"`{key}` of a `{self.name}` is {value:g}", "a number above 0")
        return value

    def as_number(self, key: str, text: str) -> float:
        """The number that a text spells.

        Raises RulecError R0610 if the text is no number, or a huge one.
        """
        try:
            value = float(text)
        except ValueError:
            value = FARTHEST_M
        if not abs(value) < FARTHEST_M:
            expected = f"a number below {FARTHEST_M:.0e}"
            raise self.wrong(f"`{key}` of a `{self.name}` is `{short(text)}`", expected)
        return value

    def wrong(self, why: str, expected: str = "") -> RulecError:
        """The error (R0610) for this element."""
        expected = expected and f"expected {expected}"
        return self.form.refused(self.path, why, self.parser.CurrentLineNumber, expected=expected)
