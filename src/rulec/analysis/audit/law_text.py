"""The text of a law, plain or as Markdown, and the places in it that rules cite."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, TypeAlias

from rulec.analysis.audit import citation_words as words
from rulec.analysis.audit.audit_messages import NO_ARTICLES
from rulec.analysis.audit.citations import PartKind, Reference, references_in
from rulec.diagnostics import Source, SourceLocation
from rulec.files.read_files import MAX_LAW_BYTES, decoded, opened, read_whole


@dataclass(frozen=True, slots=True)
class LawText:
    """The articles and annexes of a law, by kind and number, each with its text."""

    name: str
    articles: Mapping[tuple[str, str], str]

    def find(self, reference: Reference) -> str | None:
        """The text of a place with white space normalised; None if there is none.

        A sign is searched in the whole text, an article's paragraphs, items and sentences one
        within the other.
        """
        if reference.kind == "sign":
            return self._sign(reference.number)
        text = self.articles.get((reference.kind, reference.number))
        for kind, name in reference.parts:
            text = None if text is None else _part(text, kind, name)
        return None if text is None else " ".join(text.split())

    def length_of(self, reference: Reference) -> int:
        """The number of characters searched for a place; each part of it needs another pass."""
        if reference.kind == "sign":
            return sum(map(len, self.articles.values()))
        text = self.articles.get((reference.kind, reference.number), "")
        return len(text) * (1 + len(reference.parts))

    def missing(self, reference: Reference) -> str:
        """Why a place is not found: the first part of it that is missing."""
        if (reference.kind, reference.number) not in self.articles or reference.kind == "sign":
            return f"{self.name} has no {replace(reference, parts=())}"
        whole = replace(reference, parts=())
        for length in range(1, len(reference.parts) + 1):
            some = replace(reference, parts=reference.parts[:length])
            if self.find(some) is None:
                return f"{self.name} has {whole}, but no {some}"
            whole = some
        return ""

    def _sign(self, number: str) -> str | None:
        """The entry on a sign, up to the next sign; or the passage that mentions it."""
        mention = rf"(?:[Zz]eichen|[Ss]igns?)[ \t]*{re.escape(number)}(?![\w-]|\.\d)"
        for line in (rf"^[^\w\n]*{mention}", mention):
            for text in self.articles.values():
                match = re.search(line, text, re.MULTILINE)
                if match is not None:
                    following = _ANY_SIGN.search(text, match.end())
                    entry = text[match.start() : following.start() if following else None]
                    return " ".join(_without_next_row(entry).split())
        return None


_ANY_SIGN: Final = re.compile(r"^[^\w\n]*(?:[Zz]eichen|[Ss]ign)\s*\d+", re.MULTILINE)
_BETWEEN_CELLS: Final = " \t\r\n\f\v\xa0*|"
_MARKDOWN: Final = re.compile(r"^#{1,6}\s+(?P<head>.*)$", re.MULTILINE)
_LABELLED: Final = re.compile(
    rf"^[ \t*_]*(?P<head>(?!(?i:ss?|rr?)\.|[Rr]\b)(?:{words.ARTICLE}|{words.ANNEX})"
    r"[^\n]{0,200})$",
    re.MULTILINE,
)
"""A line that begins like an article's heading, in a text without heading marks.

It begins with any word by which articles are cited, except for abbreviations that no law prints as
a heading: `s.` of sections and `R` of rules also begin sentences.
"""
_SIGNED: Final = re.compile(
    rf"^[ \t*_]*(?:(?P<chapter>\d+\s*{words.CHAPTER})[^\n§]*$"
    rf"|(?P<own>\d+\s*{words.CHAPTER}\s*)?(?P<section>\d+\s?[a-z]?\s?§))",
    re.MULTILINE,
)
"""Swedish and Finnish sections, `5 §`, whose text follows on the line; and Swedish chapters."""
_NUMBERED: Final = re.compile(
    r"^[ \t*_]*(?P<head>[A-Z]?\d[\d.:-]*[a-z]?[.:]?[ \t]+[A-ZÄÖÜ][^\n]{0,200})$", re.MULTILINE
)
"""The same for articles that have only numbers."""
_CONTINUED: Final = re.compile(
    r"\s*(?:(?:Abs|Absatz|Nr|Nummer|Satz|Buchst)\b|and\b|und\b|or\b|oder\b|,|;|\()"
)


def _without_next_row(entry: str) -> str:
    """A table's entry without the number that begins the next row, and without cell marks."""
    text = entry.rstrip(_BETWEEN_CELLS)
    before = text.rstrip("0123456789")
    return before.rstrip(_BETWEEN_CELLS) if before[-1:] in [*_BETWEEN_CELLS] else text


def read_law_text(path: Path) -> LawText:
    """Read a law's text. Raises RulecError: unreadable (R0701), or without articles (R0714)."""
    with opened(path) as stream:
        source = decoded(str(path), read_whole(stream, path, MAX_LAW_BYTES))
    return law_text(source)


def law_text(source: Source) -> LawText:
    """The articles of a text, by its headings. Raises RulecError R0714 if there are none."""
    articles = dict(_articles(source.text))
    if not articles:
        raise NO_ARTICLES.error(
            SourceLocation(source.name),
            "no article was found in this text",
            help="articles begin on lines such as `### § 5 Overtaking` or `Article 5`",
        )
    return LawText(Path(source.name).name, articles)


def _articles(text: str) -> Iterator[tuple[tuple[str, str], str]]:
    marked = [
        (match.start(), match.end(), _named(match["head"])) for match in _MARKDOWN.finditer(text)
    ]
    # Every marked heading ends the article before it, even if it starts none.
    heads = marked if any(named for _, _, named in marked) else []
    heads = heads or _signed_heads(text)
    heads = heads or _plain_heads(text, _LABELLED) or _plain_heads(text, _NUMBERED)
    seen: set[tuple[str, str]] = set()
    for number, (_, end, named) in enumerate(heads):
        if named is None or named in seen:
            continue
        seen.add(named)
        yield named, text[end : heads[number + 1][0] if number + 1 < len(heads) else None]


_Head: TypeAlias = "tuple[int, int, tuple[str, str] | None]"
"""The start and end of a heading, and the article that it names."""


def _plain_heads(text: str, shape: re.Pattern[str]) -> list[_Head]:
    matches = ((match.start(), match.end(), match["head"]) for match in shape.finditer(text))
    return [
        (start, end, named)
        for start, end, head in matches
        if (named := _named(head)) and (start == 0 or text.endswith("\n\n", 0, start))
    ]


def _signed_heads(text: str) -> list[_Head]:
    """The sections of a Swedish or Finnish law, and the chapters in which they are numbered."""
    chapter, heads = "", []
    for match in _SIGNED.finditer(text):
        start, end = match.span()
        if start and not text.endswith("\n\n", 0, start):
            continue
        chapter = f"{match['chapter']} " if match["chapter"] else chapter
        section = match["section"] and (match["own"] or chapter) + match["section"]
        heads.append((start, end, _place_named(section) if section else None))
    return heads if any(named for _, _, named in heads) else []


def _named(head: str) -> tuple[str, str] | None:
    """The article or annex named at the start of a heading."""
    plain = head.strip().strip("*_ ")
    begins = re.match(
        r"(?:\S*?[§.]?\s*[A-Z]{0,3}\.?\d+[a-z]?(?:[-.:]\d+[a-z]?)*|\w+\.?\s+[A-Z]?\d+[a-z]?)"
        r"(?:(?:\.[º°]|º)?-[A-Z]\b)?",
        plain,
    )
    if begins is None or _CONTINUED.match(plain[begins.end() :]):
        return None
    return _place_named(begins[0].rstrip(".:"))


def _place_named(text: str) -> tuple[str, str] | None:
    """The one article or annex that a text names, without parts of it."""
    references, _ = references_in(text)
    reference = references[0] if len(references) == 1 and not references[0].parts else None
    return (
        None
        if reference is None or reference.kind == "sign"
        else (reference.kind, reference.number)
    )


def _part(text: str, kind: PartKind, name: str) -> str | None:
    if kind == "sentence":
        sentences = _sentences(text)
        number = int(name) if len(name) <= _MOST_DIGITS else 0
        return sentences[number - 1] if 0 < number <= len(sentences) else None
    own = _marker(kind, re.escape(name)).search(text)
    if own is None:
        return None
    following = _marker(kind, _like(name)).search(text, own.end())
    return text[own.end() : following.start() if following else None]


def _like(name: str) -> str:
    """The pattern of names of the same kind; the next one ends the part."""
    if name[0].isdigit():
        return r"\d+(?:[a-z]|-[a-z]+)?"
    return "[IVX]+" if name.isupper() else "[a-z]{1,2}"


def _marker(kind: PartKind, name: str) -> re.Pattern[str]:
    """The marker at the start of a line: `(4)`; for an item `2.`, `2)`, `(2)` or `II.`."""
    shape = rf"\((?:{name})\)" if kind == "mark" else rf"\(?(?:{name})(?:[.)°]|[ \t]*[-–—])"
    return re.compile(rf"^[ \t*_-]*{shape}", re.MULTILINE)


_SHORT: Final = re.compile(
    r"(?:\b(?:Nr|Nrn|Abs|Art|Buchst|bzw|usw|vgl|ggf|no|nos|para|paras|al|lit|St|Dr|s|ss|[A-Z])"
    r"|^[ \t]*\d+[a-z]?)\Z",
    re.MULTILINE,
)
"""Text before a full stop that does not end a sentence: `Nr.`, `z. B.`, an item's number."""
_LONGEST_SHORT: Final = 40
_MOST_DIGITS: Final = 6
"""The most digits of a sentence's number."""
_ONE_LETTER: Final = re.compile(r"\s+[A-Z]\.")
_END: Final = re.compile(r"[.!?][)“\"»]?(?=\s+[A-ZÄÖÜÉÀ§(„“\"«]|\s*\Z)")


def _sentences(text: str) -> list[str]:
    body = re.sub(r"^[ \t]*\(\w{1,4}\)[ \t]*", "", text.lstrip("\n"))
    sentences: list[str] = []
    begin, end = 0, len(body.rstrip())
    for match in _END.finditer(body):
        near = max(begin, match.start() - _LONGEST_SHORT)
        short = _SHORT.search(body, near, match.start()) or _ONE_LETTER.match(body, match.end())
        if short is None or match.end() >= end:
            sentences.append(body[begin : match.end()])
            begin = match.end()
    return [*sentences, *([body[begin:]] if body[begin:].strip() else [])]
