"""Check of a rulebook's citations against its law's text, and against the current text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from typing import Literal

from rulec.analysis.audit.citations import Reference, each_reference, references_in, unread_note
from rulec.analysis.audit.law_text import LawText
from rulec.diagnostics.diagnostic import at
from rulec.resource_limits import CITES
from rulec.rulebook.rulebook_model import Rulebook

CiteResult = Literal["found", "not-found", "unread", "law-changed"]


@dataclass(frozen=True, slots=True)
class CiteCheck:
    """The result of looking up a place that a rule cites.

    ``unread`` is text that names no article, such as a custom or another law; ``law-changed`` is a
    place whose text has changed or is gone. ``note`` has details.
    """

    rule: str
    place: str
    result: CiteResult
    note: str = ""


def check_cites(
    rulebook: Rulebook, law: LawText, law_now: LawText | None = None
) -> tuple[CiteCheck, ...]:
    """Look up the citations of the rules that are the rulebook's own law, in rule order.

    With ``law_now``, places whose text there differs, apart from white space, have changed. Raises
    RulecError R0718 if all of them together are too much text to search.
    """
    own = [rule for rule in rulebook.rules if not rule.inherited_from]
    texts = [law] if law_now is None else [law, law_now]
    amount = 0
    for rule in own:
        places = list(_looked_for(rule.cite, law))
        amount += sum(text.length_of(place) for text in texts for place in places)
        CITES.within(amount, at(rule.span), f"rulebook `{rulebook.name}` up to rule `{rule.name}`")
    return tuple(check for rule in own for check in _of_rule(rule.name, rule.cite, law, law_now))


def _of_rule(rule: str, cite: str, law: LawText, law_now: LawText | None) -> Iterator[CiteCheck]:
    for reference in _looked_for(cite, law):
        text, place = law.find(reference), str(reference)
        if text is None:
            yield CiteCheck(rule, place, "not-found", law.missing(reference))
        elif law_now is None:
            yield CiteCheck(rule, place, "found")
        else:
            now = law_now.find(reference)
            if now is None:
                yield CiteCheck(rule, place, "law-changed", law_now.missing(reference))
            elif now != text:
                yield CiteCheck(rule, place, "law-changed", _difference(text, now))
            else:
                yield CiteCheck(rule, place, "found")
    for piece in references_in(cite)[1]:
        yield CiteCheck(rule, piece, "unread", unread_note(piece))


def _looked_for(cite: str, law: LawText) -> Iterator[Reference]:
    """The places that a ``cite`` names; an annex that only locates the next sign is left out."""
    places = tuple(each_reference(cite, frozenset(law.articles)))
    for place, following in zip_longest(places, places[1:]):
        if place.kind != "annex" or following is None or following.kind != "sign":
            yield place


_SHOWN = 60
"""The number of characters of a change that are shown, from where the texts differ."""


def _difference(before: str, after: str) -> str:
    """The start of the difference between two texts, from the beginning of a word."""
    pairs = zip(before, after, strict=False)
    same = next((at for at, (old, new) in enumerate(pairs) if old != new), None)
    start = min(len(before), len(after)) if same is None else same
    start = before.rfind(" ", 0, start) + 1
    was, now = (text[start : start + _SHOWN] for text in (before, after))
    return f"was “{was}”, is “{now}”"
