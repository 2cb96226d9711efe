"""Parser of citations, such as `§ 5(4) s. 2, 7a`, which cites two articles."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, TypeAlias

from rulec.analysis.audit import citation_words as words

ReferenceKind: TypeAlias = Literal["article", "annex", "sign"]

PartKind: TypeAlias = Literal["mark", "sentence", "item"]
"""`(4)`; `s. 2`, which is counted; `no. 2`, `lit. c`, `II`, as written at the start of a line."""


@dataclass(frozen=True, slots=True)
class Reference:
    """A place in a law: an article, an annex or a traffic sign, and the cited part of it.

    ``label`` is the word before the number. A ``number`` such as `20-22` may be a range.
    """

    kind: ReferenceKind
    number: str
    parts: tuple[tuple[PartKind, str], ...] = ()
    label: str = ""

    def __str__(self) -> str:
        return f"{self.label}{self.number}{''.join(_shown(*part) for part in self.parts)}"

    def several(self) -> tuple[Reference, ...]:
        """The articles of a range such as `20-22`; only this reference if it is not a range."""
        ends = re.fullmatch(r"(\d{1,6})-(\d{1,6})", self.number)
        if ends is None or not 0 < int(ends[2]) - int(ends[1]) <= _LONGEST_RANGE:
            return (self,)
        numbers = map(str, range(int(ends[1]), int(ends[2]) + 1))
        return tuple(Reference(self.kind, number, (), self.label) for number in numbers)


Listed: TypeAlias = "Sequence[tuple[str, Reference | None]]"
"""The articles as listed, with the place that each text names; None for a name of its own."""

_LONGEST_RANGE: Final = 50
_MOST_PARTS: Final = 30
"""A larger number after `no. 2` is an article."""
_LABELS: Final[dict[ReferenceKind, str]] = {
    "article": words.ARTICLE,
    "annex": words.ANNEX,
    "sign": words.SIGN,
}
_LABEL: Final = "|".join(f"(?P<{kind}>{of})" for kind, of in _LABELS.items())
_SUFFIX: Final = r"(?:[a-z]|bis|ter|quater|quinquies|sexies|septies|octies)"
_SPACED: Final = r"(?:[ ](?P<spaced>[a-z])(?![\w.)°])(?!\s+\d))"
"""The letter of an article such as `7 a`, which is not the word `a` or `e` before a number."""
_NUMBER: Final = (
    r"(?P<number>(?:[LRDA]\.\s?(?=\d)|[A-Z]{0,3}[-.]?)\d+"
    rf"(?:[A-Z]{{0,2}}(?![A-Za-z])|{_SUFFIX}?(?![a-z]))"
    rf"(?:[-.:]\d+{_SUFFIX}?(?![a-z]))*)(?:\.[º°]|º)?(?:-(?P<added>[A-Z])(?!\w))?{_SPACED}?"
)
"""Portuguese and Spanish articles may be ordinals: `18.º`, `5º`; what is added is `18.º-A`."""
_HEAD: Final = re.compile(rf"(?:(?:{_LABEL})\s*)?{_NUMBER}")
_BEFORE_SIGN: Final = re.compile(
    rf"(?:(?P<chapter>\d+)\s*{words.CHAPTER}\s*)?(?P<section>\d+)(?:\s?(?P<letter>[a-z]))?"
    r"\s*(?P<sign>§§?)"
)
"""Swedish and Finnish: `3 kap. 15 §`, which is 3:15, and `7 a §`."""
_ORDINAL: Final = "|".join(words.COUNTED.values())
_PART: Final = re.compile(
    rf"\s*(?:\((?P<mark>\w{{1,4}})\)|{words.PARAGRAPH}\s*(?P<paragraph>\d+[a-z]?)\b"
    rf"|{words.SENTENCE}\s*(?P<sentence>\d+)"
    rf"|(?:{words.NUMBER}|{words.LETTER})\s*"
    r"(?P<item>\d+(?:-(?:bis|ter|quater)\b)?|[a-z]\b)(?:\s?(?P<letter>[a-z])\b)?[)°]?"
    rf"|(?P<before>\d+)\s+{words.PARAGRAPH}(?!\w|\s*\d)"
    rf"|(?:(?P<count>\d+)\.\s*|(?P<ordinal>(?i:{_ORDINAL}))\s+)"
    rf"(?:(?P<counted_paragraph>{words.PARAGRAPH})|(?:{words.SENTENCE}|(?i:pkt\.?)))(?!\w)"
    r"|(?P<degree>\d+)°|(?<=\))(?P<close>\d+)\b|(?P<roman>[IVX]+\b))"
)
_FURTHER: Final = re.compile(r"\d+|[a-z]|[IVX]+")
_BETWEEN: Final = re.compile(
    rf"\s*(?:,|;|\b{words.AND}\b|&|(?<=[\d)º])\s+{words.AND_IN_A_LETTER}\s+"
    r"(?=[\d(]|(?i:art|čl)))\s*"
)
_CZECH_AND: Final = re.compile(r"(§[^§,]*[\d)])\s+a\s+(?=§)")
_UP_TO: Final = re.compile(r"(?:\s*[-–]\s*|\s+(?:to|bis|til|till|tot|do)\s+)(?:\(\w{1,4}\)|\d+\b)")
_YEAR: Final = re.compile(r"\s*\((?:19|20)\d\d\)")


def _shown(kind: PartKind, name: str) -> str:
    if kind == "mark":
        return f"({name})"
    if kind == "sentence":
        return f" s. {name}"
    return f" no. {name}" if name[0].isdigit() else name if name.islower() else f" {name}"


def references_in(cite: str) -> tuple[tuple[Reference, ...], tuple[str, ...]]:
    """The places that a ``cite`` names, in order, and the parts of it that name none.

    A number without a word before it is an article of the same kind as the one before; after `s.
    3`, `no. 2` or `II` it is another sentence or item: `§ 5(4) s. 3, 4` cites two sentences, `§
    46(6), 47` two articles.
    """
    references: list[Reference] = []
    unread: list[str] = []
    kind: ReferenceKind | None = None
    label = ""
    text = ""
    for piece in filter(None, _BETWEEN.split(_CZECH_AND.sub(r"\1, ", cite.strip()))):
        text, before = _YEAR.sub("", piece).strip(), text
        if references and (further := _further(text, references[-1], before)) is not None:
            references[-1:] = further
            continue
        head = _head(text)
        if head is None or (head.kind is None and kind is None and not text[:1].isalnum()):
            unread.append(piece)
            continue
        if head.kind is not None:
            kind, label = head.kind, head.label
        parts, end = _parts(text, head.end)
        if text[end:].strip():
            unread.append(piece)
            continue
        references.append(Reference(kind or "article", head.number, parts, label))
    return tuple(references), tuple(unread)


@dataclass(frozen=True, slots=True)
class _Head:
    """The beginning of a citation up to an article's number; ``kind`` is None without a label."""

    kind: ReferenceKind | None
    label: str
    number: str
    end: int


def _head(text: str) -> _Head | None:
    swedish = _BEFORE_SIGN.match(text)
    if swedish is not None:
        chapter = f"{swedish['chapter']}:" if swedish["chapter"] else ""
        number = f"{chapter}{swedish['section']}{swedish['letter'] or ''}"
        return _Head("article", "" if chapter else f"{swedish['sign']} ", number, swedish.end())
    match = _HEAD.match(text)
    if match is None:
        return None
    kind = next((name for name in _LABELS if match[name]), None)
    number = re.sub(r"^([A-Z])\.\s?", r"\1", match["number"]) + (match["spaced"] or "")
    number += f"-{match['added']}" if match["added"] else ""
    return _Head(kind, f"{match[kind]} " if kind else "", number, match.end())


def _further(text: str, before: Reference, written: str) -> tuple[Reference, ...] | None:
    """What stands for the place before, as ``written``, and a further part of the same article.

    After `§ 21760(c)` it is another part, `(d)`; so is a number after `s. 3` or `stk. 2`. But
    `stk. 2` after `§ 7` is within it.
    """
    parts, end = _parts(text, 0)
    section = before.label.lower().startswith("s") and text.lower().startswith("s")
    if parts and end == len(text) and not section:
        levels = [at for at, one in enumerate(before.parts) if _alike(one, parts[0])]
        if not levels and text[0] not in "(IVX":
            return (replace(before, parts=(*before.parts, *parts)),)
        depth = max(0, len(before.parts) - len(parts))
        if levels and text[0] != "(":
            depth = levels[0]
        if parts[0][0] != "mark" or before.parts:
            return before, replace(before, parts=(*before.parts[:depth], *parts))
    far = text.isdecimal() and (len(text) > len(str(_MOST_PARTS)) or int(text) > _MOST_PARTS)
    if far or not before.parts or not _FURTHER.fullmatch(text):
        return None
    kind = before.parts[-1][0]
    levels = [at for at, one in enumerate(before.parts) if _alike(one, (kind, text))]
    if not levels or (kind == "mark" and written.endswith(")")):
        return None
    return before, replace(before, parts=(*before.parts[: levels[-1]], (kind, text)))


def _alike(one: tuple[PartKind, str], other: tuple[PartKind, str]) -> bool:
    """Whether two parts are on the same level: two paragraphs, two numbers, two letters."""
    shapes = [(kind, name[0].isdigit(), name[0].isupper()) for kind, name in (one, other)]
    return shapes[0] == shapes[1]


def _parts(text: str, start: int) -> tuple[tuple[tuple[PartKind, str], ...], int]:
    parts: list[tuple[PartKind, str]] = []
    while (match := _PART.match(text, start)) is not None:
        start = match.end()
        parts += _of_match(match)
        # Only the first of `s. 2-3` or `(1)-(4)` is used.
        if (more := _UP_TO.match(text, start)) is not None:
            start = more.end()
    if parts and (match := re.compile(r"\s+\d+\b").match(text, start)):
        parts.append(("item", match[0].strip()))
        start = match.end()
    return tuple(parts), start


def _of_match(match: re.Match[str]) -> Iterator[tuple[PartKind, str]]:
    counted = match["count"] or next(
        (
            number
            for number, names in words.COUNTED.items()
            if match["ordinal"] and re.fullmatch(names, match["ordinal"], re.IGNORECASE)
        ),
        "",
    )
    if paragraph := match["mark"] or match["paragraph"] or match["before"]:
        yield "mark", paragraph
    elif counted:
        yield "mark" if match["counted_paragraph"] else "sentence", counted
    elif match["sentence"]:
        yield "sentence", match["sentence"]
    else:
        yield "item", match["item"] or match["degree"] or match["close"] or match["roman"]
        if match["letter"]:
            yield "item", match["letter"]


def unread_note(piece: str) -> str:
    """Why a part of a ``cite`` cannot be looked up."""
    later = re.search(r"(?<!^)(?<!\w)(?:§|[Aa]rt\b)", piece)
    if later is None:
        return "it names no article to look up"
    return f"`{piece[: later.start()].strip()}` before the article is taken for another law"


def article_listed(number: str) -> Reference | None:
    """The place that an entry of `provisions` names; None if its text is a name of its own."""
    references, unread = references_in(number)
    return references[0] if len(references) == 1 and not unread else None


def covers(listed: Reference, cited: Reference) -> bool:
    """Whether a listed article, or part of one, contains a cited place."""
    same = (listed.kind, listed.number) == (cited.kind, cited.number)
    return same and cited.parts[: len(listed.parts)] == listed.parts


def contains_name(cite: str, name: str) -> bool:
    """Whether a ``cite`` contains a listed name that is no article, such as `VRV 4`."""
    return re.search(rf"(?<!\w){re.escape(name)}(?!\w|[-.:]\d)", cite) is not None


def most_specific(cited: Reference, listed: Listed) -> list[str]:
    """The listed articles that contain a cited place, the most specific first."""
    fitting = [
        (len(reference.parts), number)
        for number, reference in listed
        if reference is not None and covers(reference, cited)
    ]
    return [number for _, number in sorted(fitting, key=lambda entry: -entry[0])]


def listed_places(numbers: Iterable[str]) -> Listed:
    """The articles as listed, each with the place that it names."""
    return [(number, article_listed(number)) for number in numbers]


def known_places(listed: Listed) -> frozenset[tuple[str, str]]:
    """The kinds and numbers of listed articles."""
    return frozenset(
        (reference.kind, reference.number) for _, reference in listed if reference is not None
    )


def cited_entries(cite: str, listed: Listed) -> Iterator[str]:
    """The listed articles that a ``cite`` names or has a part of; one may come twice."""
    yield from (
        number for number, reference in listed if reference is None and contains_name(cite, number)
    )
    of_its_year = [entry for entry in listed if _year(entry[0]) in cite]
    for reference in each_reference(cite, known_places(listed)):
        yield from most_specific(reference, of_its_year)[:1]


def unlisted_places(cite: str, listed: Listed) -> Iterator[str]:
    """What a ``cite`` names that is not listed; text without a number, such as a custom, is not."""
    kinds = {reference.kind for _, reference in listed if reference is not None}
    names = [number for number, reference in listed if reference is None]
    for piece in references_in(cite)[1]:
        known = any(contains_name(piece, name) for name in names)
        if not known and piece[0] != "(" and re.search(r"\d", piece):
            yield piece
    if any(contains_name(cite, name) for name in names):
        return
    for reference in each_reference(cite, known_places(listed)):
        if reference.kind in kinds and not most_specific(reference, listed):
            yield str(reference)


def _year(number: str) -> str:
    """The year after an article's number, as in `reg. 6 (1989)`; empty if there is none."""
    match = re.search(r"\((?:19|20)\d\d\)$", number)
    return match[0] if match else ""


def each_reference(cite: str, known: frozenset[tuple[str, str]]) -> Iterator[Reference]:
    """The places that a ``cite`` names; a range that is not an article of the law is split up."""
    for reference in references_in(cite)[0]:
        if (reference.kind, reference.number) in known:
            yield reference
        else:
            yield from reference.several()
