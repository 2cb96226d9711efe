"""Markdown (CommonMark with tables) in which any text is shown literally."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rulec.report.text.terminal_text import visible

_SIGNS = re.compile(r"[\\`*_{}\[\]<>#|~!&]")
_START = re.compile(r"\s*([-+=]|\d+(?=[.)]))")
_ADDRESS = re.compile(r"https?://[^\s<>|\\`]+")


CONTENTS = "Contents"
"""The heading of the list of contents of an English page."""


@dataclass(frozen=True, slots=True)
class PageTexts:
    """A page's title, the heading above its list of contents, and its language.

    What can be folded, which is long or below a heading of level 4, is open unless ``is_closed``.
    """

    title: str
    contents: str = ""
    language: str = "en"
    is_closed: bool = False


def escaped(text: str) -> str:
    """A text on one line, with Markdown's special characters escaped."""
    plain = _SIGNS.sub(r"\\\g<0>", visible(text))
    start = _START.match(plain)
    if start is None:
        return plain
    # A list's dash, a heading's underline, or a list item's number.
    cut = start.end(1) if start[1].isdigit() else start.start(1)
    return f"{plain[:cut]}\\{plain[cut:]}"


def linked(text: str) -> str:
    """An escaped text with addresses of pages as links."""
    parts = []
    end = 0
    for match_ in _ADDRESS.finditer(text):
        before = text[end : match_.start()]
        parts += [escaped(before) if before.strip() else before, f"<{match_[0]}>"]
        end = match_.end()
    rest = text[end:]
    return "".join([*parts, escaped(rest) if rest.strip() else rest])


def code(text: str) -> str:
    """A name or formula as code; any characters are allowed, in tables as well."""
    shown = visible(text).replace("|", r"\|")
    longest = max((len(run) for run in re.findall("`+", shown)), default=0)
    if not longest:
        return f"`{shown}`"
    fence = "`" * (longest + 1)
    return f"{fence} {shown} {fence}"


def fenced(text: str, language: str) -> str:
    """Lines of code as a fenced block."""
    longest = max((len(run) for run in re.findall("`+", text)), default=0)
    fence = "`" * max(3, longest + 1)
    return f"{fence}{language}\n{text}\n{fence}"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; its cells are already Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def anchors(headings: Sequence[str]) -> list[str]:
    """A distinct anchor for each plain-text heading of a page, formed as most viewers do."""
    taken: set[str] = set()
    names = []
    for heading in headings:
        plain = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        name, number = plain, 0
        while name in taken:
            number += 1
            name = f"{plain}-{number}"
        taken.add(name)
        names.append(name)
    return names


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading; ``text`` is plain text."""

    level: int
    text: str


Block = Heading | str
"""A heading, or anything else as Markdown."""


def placed(blocks: Iterable[Block]) -> list[tuple[Heading, str]]:
    """The headings of a page, each with its anchor."""
    headings = [block for block in blocks if isinstance(block, Heading)]
    names = anchors([heading.text for heading in headings])
    return list(zip(headings, names, strict=True))


def with_contents(top: Sequence[Block], title: str, body: Sequence[Block]) -> list[Block]:
    """A page with a list of contents between its top and its body.

    The list has the body's headings of levels 2 and 3 as links.
    """
    blocks = [*top, Heading(2, title), *body]
    own = {id(block) for block in body}
    contents = "\n".join(
        f"{'  ' * (heading.level - 2)}- [{escaped(heading.text)}](#{place})"
        for heading, place in placed(blocks)
        if id(heading) in own and heading.level in (2, 3)
    )
    return [*top, blocks[len(top)], contents, *body]


def written(blocks: Iterable[Block]) -> str:
    """The page, without a final line end."""
    return "\n\n".join(
        f"{'#' * block.level} {escaped(block.text)}" if isinstance(block, Heading) else block
        for block in blocks
    )
