"""The body of a page: Markdown as HTML whose headings can be linked to, with folds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from html import escape
from itertools import pairwise

from markdown_it import MarkdownIt
from markdown_it.token import Token
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexer import Lexer
from pygments.lexers.diff import DiffLexer

from rulec.report.text.markdown import PageTexts, anchors
from rulec.report.text.pygments_lexer import RulecLexer

_MOST_NESTED = 800
"""Deeper content (two levels for each nested list) is omitted, with all that follows it."""

MOST_UNFOLDED = 30
"""The most rows and paragraphs of a section that is never folded."""

_LEXERS: dict[str, type[Lexer]] = {"rulec": RulecLexer, "diff": DiffLexer}


def body_of(
    markdown: str,
    page: PageTexts,
    figures: Mapping[str, str],
    cell_class: Callable[[str], str],
) -> str:
    """The body of a page; see ``as_html``."""
    options = {"html": False, "highlight": _highlighted, "maxNesting": _MOST_NESTED}
    parser = MarkdownIt("commonmark", options).enable("table")
    tokens = parser.parse(markdown)
    _name_headings(tokens)
    _scope_cells(tokens)
    _class_cells(tokens, cell_class)
    _draw_figures(tokens, figures)
    shown = list(_wrapped(_folded(tokens, page), page.contents))
    return str(parser.renderer.render(shown, parser.options, {}))


def _highlighted(text: str, language: str, _: str) -> str:
    lexer = _LEXERS.get(language)
    if lexer is None:
        return ""
    return str(highlight(text, lexer(), _formatter()))


@cache
def _formatter() -> HtmlFormatter[str]:
    # Classes instead of colours, so that they follow the reader's theme. Making it takes 1 ms.
    return HtmlFormatter(nowrap=True)


def _name_headings(tokens: Sequence[Token]) -> None:
    """Give every heading an id that can be linked to."""
    headings = [pair for pair in pairwise(tokens) if pair[0].type == "heading_open"]
    texts = ["".join(child.content for child in inline.children or ()) for _, inline in headings]
    for (token, _), name in zip(headings, anchors(texts), strict=True):
        token.attrSet("id", name)


def _scope_cells(tokens: Sequence[Token]) -> None:
    first = False
    for token in tokens:
        if token.type == "tr_open":
            first = True
        elif token.type == "th_open":
            token.attrSet("scope", "col")
        elif token.type in ("td_open", "td_close") and first:
            token.tag = "th"
            if token.type == "td_open":
                token.attrSet("scope", "row")
            first = token.type == "td_open"


def _class_cells(tokens: Sequence[Token], cell_class: Callable[[str], str]) -> None:
    for token, inline in pairwise(tokens):
        name = cell_class(inline.content) if token.type == "td_open" else ""
        if name:
            token.attrSet("class", name)


def _draw_figures(tokens: Sequence[Token], figures: Mapping[str, str]) -> None:
    for token in tokens:
        for child in token.children or ():
            svg = figures.get(str(child.attrGet("src"))) if child.type == "image" else None
            if svg is not None:
                child.type, child.tag = "html_inline", ""
                name = f'<svg aria-label="{escape(child.content)}" '
                child.content = svg.replace("<svg ", name, 1)


def _folded(tokens: Sequence[Token], page: PageTexts) -> Iterator[Token]:
    """The tokens with folds: below headings of level 4, and long sections without headings."""
    starts = [place for place, token in enumerate(tokens) if _starts(token)]
    for start, end in pairwise([0, *starts, len(tokens)]):
        section = tokens[start:end]
        folds = bool(section) and _folds(section)
        if folds:
            yield _raw(f"<details{'' if page.is_closed else ' open'}><summary>\n")
        for token in section:
            yield token
            if folds and token.type == "heading_close":
                yield _raw("</summary>\n")
        if folds:
            yield _raw("</details>\n")


def _starts(token: Token) -> bool:
    return token.type in ("heading_open", "hr") and not token.level


def _folds(section: Sequence[Token]) -> bool:
    """Whether to fold a section, which begins with its heading."""
    if section[0].tag == "h2":
        parts = sum(token.type in ("tr_open", "paragraph_open", "fence") for token in section)
        return parts > MOST_UNFOLDED
    return section[0].tag == "h4"


def _wrapped(tokens: Iterable[Token], contents: str) -> Iterator[Token]:
    below_contents = False
    for token in tokens:
        if token.type == "inline" and token.content == contents:
            below_contents = True
        opens_contents = below_contents and token.type == "bullet_list_open"
        closes_contents = below_contents and token.type == "bullet_list_close" and not token.level
        if opens_contents and not token.level:
            yield _raw(f'<nav aria-label="{escape(contents)}">\n')
        if token.type == "table_open":
            yield _raw('<div class="wide" tabindex="0">\n')
        yield token
        if token.type == "table_close":
            yield _raw("</div>\n")
        if closes_contents:
            below_contents = False
            yield _raw("</nav>\n")


def _raw(html: str) -> Token:
    return Token("html_block", "", 0, content=html)
