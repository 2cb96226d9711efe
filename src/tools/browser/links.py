"""Links of a served site: which pages can be reached, and which links lead nowhere."""

from __future__ import annotations

import urllib.error
import urllib.request
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from urllib.parse import unquote, urldefrag, urljoin

_LINKS = {"a": "href", "link": "href", "img": "src", "script": "src", "form": "action"}


class _LinkedPage(HTMLParser):
    """The places of a page, and the addresses that it names."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.places: set[str] = set()
        self.named: list[tuple[str, str]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.places |= {values.get(name) or "" for name in ("id", "name")}
        if link := values.get(_LINKS.get(tag, "")):
            self.named.append((tag, link))


@dataclass(frozen=True)
class LinkedSite:
    """A site, followed from its front page.

    Attributes:
        pages: the addresses of its pages, as they were found.
        faults: the links that lead nowhere.
    """

    pages: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)


def followed(front: str) -> LinkedSite:
    """Follow all links within a site; those to other hosts are left alone."""
    site = LinkedSite()
    known: dict[str, _LinkedPage | None] = {}
    waiting = [(front, front, "")]
    wanted: list[tuple[str, str, str]] = []
    while waiting:
        at, address, place = waiting.pop(0)
        if address not in known:
            known[address] = page = _read(address)
            if page is None:
                site.faults.append(f"{at}: {address} is not there")
            elif page.named or page.places:
                site.pages.append(address)
                waiting += _links(address, page, front)
        if place:
            wanted.append((at, address, place))
    site.faults.extend(
        f"{at}: {address} has no place #{place}"
        for at, address, place in wanted
        if (page := known[address]) is not None and place not in page.places
    )
    return site


def _links(address: str, page: _LinkedPage, front: str) -> Iterator[tuple[str, str, str]]:
    for tag, link in page.named:
        target, place = urldefrag(urljoin(address, link))
        if target.startswith(front):
            yield address, target, unquote(place) if tag == "a" else ""


def _read(address: str) -> _LinkedPage | None:
    """A page, empty for what is no page; None if it is not there."""
    try:
        with urllib.request.urlopen(address) as answer:
            is_page = answer.headers.get_content_type() == "text/html"
            return _LinkedPage(answer.read().decode("utf-8") if is_page else "")
    except urllib.error.HTTPError:
        return None
