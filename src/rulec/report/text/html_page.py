"""Markdown as one HTML page for screen and paper, without scripts."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping
from hashlib import sha256
from html import escape
from pathlib import Path

from rulec.files.text_templates import filled
from rulec.report.text.markdown import PageTexts

_PAGE = Path(__file__).with_name("html_page.html")
_STYLE = Path(__file__).with_name("html_page.css")


def as_html(
    markdown: str,
    page: PageTexts,
    figures: Mapping[str, str] | None = None,
    cell_class: Callable[[str], str] = lambda _: "",
) -> str:
    """The page; HTML in the Markdown is shown as text.

    ``figures`` maps addresses of images to the SVG elements that replace them. ``cell_class`` gives
    the CSS class for a table cell's text, empty for none.
    """
    # markdown-it and Pygments take 30 ms, only for pages.
    from rulec.report.text.page_body import body_of

    body = body_of(markdown, page, figures or {}, cell_class)
    style = f"\n{_STYLE.read_text(encoding='utf-8')}"
    places = {
        "language": page.language,
        "policy": policy([style], []),
        "title": escape(page.title),
        "style": style,
        "body": body,
    }
    return filled(_PAGE, places).removesuffix("\n")


def policy(styles: Iterable[str], scripts: Iterable[str]) -> str:
    """The content policy of a page that loads nothing, for the texts of its own elements."""
    own_styles, own_scripts = (
        " ".join(map(_hash, texts)) or "'none'" for texts in (styles, scripts)
    )
    return f"default-src 'none'; style-src {own_styles}; script-src {own_scripts}"


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
