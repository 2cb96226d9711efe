"""All diagnostic codes, as the page on codes explains them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from textwrap import indent
from typing import Literal, TypeAlias

from rulec.report.text.terminal_text import broken
from rulec.resources import codes_page
from rulec.value_display import short_repr

ExampleKind: TypeAlias = Literal[
    "rules",
    "compiled",
    "analyzed",
    "examples",
    "maneuvers",
    "trace",
    "scenario",
    "command",
    "python",
    "circumstance",
]
"""Kinds of examples, by how they are run.

``rules``: a rulebook or a vocabulary to check. ``compiled``: a rulebook to compile. ``analyzed``: a
rulebook to analyze. ``examples``: a rulebook whose examples are run. ``maneuvers``: a rulebook by
which the maneuvers of scenario s1 are judged. ``trace``: a line to judge by ``esterle2019``.
``scenario``: a file to build the graph of. ``command``: lines for a POSIX shell in an empty folder.
``python``: a program. ``circumstance``: no input causes it, so there is no example.
"""

_KINDS: Mapping[str, ExampleKind] = {
    "Wrong (to check)": "rules",
    "Wrong (to compile)": "compiled",
    "Wrong (to analyze)": "analyzed",
    "Wrong (to test)": "examples",
    "Wrong (to judge the maneuvers of `s1` by)": "maneuvers",
    "Wrong (a trace, to judge by `esterle2019`)": "trace",
    "Wrong (a scenario, to build the graph of)": "scenario",
    "Wrong (in a shell)": "command",
    "Wrong (from Python)": "python",
}
"""The headings of wrong examples."""

_SECTION = re.compile(
    r"^### (?P<code>R\d{4}): (?P<title>[^\n]+)\n\n(?P<text>.*?)\n(?=\n##+ R\d|\Z)",
    re.MULTILINE | re.DOTALL,
)
_EXAMPLE = re.compile(
    r"^(?P<head>\w[^\n]*):\n\n```\w+ \w+\n(?P<text>.*?)\n```$", re.MULTILINE | re.DOTALL
)


@dataclass(frozen=True, slots=True)
class CodeExplanation:
    """What the page says about a code.

    ``title``: one line. ``why``: its meaning and what to do, in a paragraph. ``bad``: a small
    example that causes this code and no other. ``good``: the same example, corrected. ``markdown``
    is all of this without the title.
    """

    __repr__ = short_repr

    code: str
    title: str
    why: str
    kind: ExampleKind
    bad: str
    good: str
    markdown: str

    def as_text(self, width: int = 80) -> str:
        """The explanation for a terminal; its examples keep their lines, however wide."""
        title = f"{self.code}: {self.title}"
        return "\n\n".join(["\n".join(broken(title, width)), self.as_plain_text(width)])

    def as_plain_text(self, width: int = 80) -> str:
        """The explanation without its title, for a format that has that elsewhere."""
        examples = [
            f"{example['head']}:\n\n{indent(example['text'], '    ')}"
            for example in _EXAMPLE.finditer(self.markdown)
        ]
        return "\n\n".join(["\n".join(broken(self.why, width)), *examples])


@cache
def all_codes() -> dict[str, CodeExplanation]:
    """Every code by its text, in ascending order."""
    page = codes_page().read_text(encoding="utf-8")
    return {found["code"]: _explanation(found) for found in _SECTION.finditer(page)}


def as_sections() -> str:
    """All explanations in Markdown, a section a stage."""
    page = codes_page().read_text(encoding="utf-8")
    return page[page.index("\n## ") + 1 :].rstrip("\n")


def _explanation(found: re.Match[str]) -> CodeExplanation:
    markdown = found["text"]
    examples = [(example["head"], example["text"]) for example in _EXAMPLE.finditer(markdown)]
    (head, bad), (_, good) = examples or [("", ""), ("", "")]
    return CodeExplanation(
        code=found["code"],
        title=found["title"],
        why=markdown.partition("\n\n")[0].replace("\n", " "),
        kind=_KINDS[head] if head else "circumstance",
        bad=bad,
        good=good,
        markdown=markdown,
    )
