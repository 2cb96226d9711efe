"""Parser of citations, such as `§ 5(4) s. 2, 7a`, which cites two articles."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final, Literal, TypeAlias

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


_LONGEST_RANGE: Final = 50
_MOST_PARTS: Final = 30
"""A larger number after `no. 2` is an article."""
_LABELS: Final[dict[ReferenceKind, str]] = {
    "article": r"§§?|[Aa]rt(?:ic(?:le|olo|ulo)|ikel|ículo)?s?\.?|[Rr](?:ule|egel)s?|rr?\."
    r"|[Rr]eg(?:ulation)?s?\.?|ss?\.|[Ss]ec(?:tion)?s?\.?",
    "annex": r"[Aa]nnexe?|[Aa]nlage|[Aa]ppendix|[Ss]chedule|[Bb]ijlage",
    "sign": r"[Ss]igns?|Z(?:eichen)?",
}
_LABEL: Final = "|".join(f"(?P<{kind}>{words})" for kind, words in _LABELS.items())
_NUMBER: Final = r"(?P<number>[A-Z]{0,3}[-.]?\d+[a-z]?(?![a-z])(?:[-.:]\d+[a-z]?(?![a-z]))*)"
_HEAD: Final = re.compile(rf"(?:(?:{_LABEL})\s*)?{_NUMBER}")
_SENTENCE: Final = r"(?:ss?\.|sentences?|Satz|Sätze|S\.)"
_ITEM: Final = (
    r"(?:nos?\.?|Nrn?\.?|Nummern?|lit\.?|letters?|Buchst\.?|items?|points?|p\.|pkt\.?|c\.|comma)"
)
_PART: Final = re.compile(
    rf"\s*(?:\((?P<mark>\w{{1,4}})\)|(?:Abs\.?|Absatz|al\.)\s*(?P<paragraph>\d+[a-z]?)\b"
    rf"|{_SENTENCE}\s*(?P<sentence>\d+)"
    rf"|{_ITEM}\s*(?P<item>\d+(?:-(?:bis|ter|quater)\b)?|[a-z]\b)(?:\s?(?P<letter>[a-z])\b)?"
    r"|(?P<roman>[IVX]+\b))"
)
_FURTHER: Final = re.compile(r"\d+|[a-z]|[IVX]+")
_BETWEEN: Final = re.compile(r"\s*(?:,|;|\band\b|\bund\b|\bet\b|&)\s*")
_UP_TO: Final = re.compile(r"\s*[-–]\s*(?:\(\w{1,4}\)|\d+\b)")
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
    for piece in filter(None, _BETWEEN.split(cite.strip())):
        text = _YEAR.sub("", piece).strip()
        further = _further(text, references)
        if further is not None:
            references.append(further)
            continue
        match = _HEAD.match(text)
        if match is None:
            unread.append(piece)
            continue
        labels = [name for name in _LABELS if match[name]]
        kind, label = (labels[0], f"{match[labels[0]]} ") if labels else (kind, label)
        if kind is None and not match[0][:1].isalnum():
            unread.append(piece)
            continue
        parts, end = _parts(text, match.end())
        if text[end:].strip():
            unread.append(piece)
            continue
        of = kind or "article"
        references.append(Reference(of, match["number"], parts, label))
    return tuple(references), tuple(unread)


def _further(text: str, references: list[Reference]) -> Reference | None:
    """Another part of the article before: `(d)`, or a number after `s. 3`."""
    if not references:
        return None
    before = references[-1]
    parts, end = _parts(text, 0)
    if parts and end == len(text):
        kinds = [kind for kind, _ in before.parts]
        depth = max(0, len(before.parts) - len(parts))
        if parts[0][0] != "mark" and parts[0][0] in kinds:
            depth = kinds.index(parts[0][0])
        if parts[0][0] != "mark" or before.parts:
            whole = (*before.parts[:depth], *parts)
            return replace(before, parts=whole)
    match = _FURTHER.fullmatch(text)
    far = text.isdecimal() and (len(text) > len(str(_MOST_PARTS)) or int(text) > _MOST_PARTS)
    if match and not far and before.parts and before.parts[-1][0] != "mark":
        last = (before.parts[-1][0], text)
        whole = (*before.parts[:-1], last)
        return replace(before, parts=whole)
    return None


def _parts(text: str, start: int) -> tuple[tuple[tuple[PartKind, str], ...], int]:
    parts: list[tuple[PartKind, str]] = []
    while (match := _PART.match(text, start)) is not None:
        start = match.end()
        if match["mark"] or match["paragraph"]:
            parts.append(("mark", match["mark"] or match["paragraph"]))
        elif match["sentence"]:
            parts.append(("sentence", match["sentence"]))
        else:
            parts.append(("item", match["item"] or match["roman"]))
            if match["letter"]:
                parts.append(("item", match["letter"]))
        # Only the first of `s. 2-3` or `(1)-(4)` is used.
        if (more := _UP_TO.match(text, start)) is not None:
            start = more.end()
    if parts and (match := re.compile(r"\s+\d+\b").match(text, start)):
        parts.append(("item", match[0].strip()))
        start = match.end()
    return tuple(parts), start


def article_listed(number: str) -> Reference | None:
    """The place that an entry of `provisions` names; None if its text is a name of its own."""
    references, unread = references_in(number)
    return references[0] if len(references) == 1 and not unread else None


def covers(listed: Reference, cited: Reference) -> bool:
    """Whether a listed article, or part of one, contains a cited place."""
    same = (listed.kind, listed.number) == (cited.kind, cited.number)
    return same and cited.parts[: len(listed.parts)] == listed.parts


def each_reference(cite: str, known: frozenset[tuple[str, str]]) -> Iterator[Reference]:
    """The places that a ``cite`` names; a range that is not an article of the law is split up."""
    for reference in references_in(cite)[0]:
        if (reference.kind, reference.number) in known:
            yield reference
        else:
            yield from reference.several()
