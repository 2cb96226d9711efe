"""Coverage of a law by a rulebook: the treatment of each article."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from rulec.analysis.audit.citations import Reference, article_listed, covers, each_reference
from rulec.rulebook.rulebook_model import Certainty, Provision, Rule, Rulebook
from rulec.value_display import short_repr

ProvisionState = Literal["covered", "silent", "not machine-readable", "to do"]


@dataclass(frozen=True, slots=True)
class ListedProvision:
    """An article of the rulebook's law, and the rules that cite it.

    It is ``covered`` if a rule that is the rulebook's own law cites it; otherwise ``state`` is what
    the rulebook declares, and ``because`` its reason. ``certainty`` is that of its number and
    heading.
    """

    __repr__ = short_repr

    number: str
    heading: str
    state: ProvisionState
    rules: tuple[str, ...] = ()
    because: str = ""
    link: str = ""
    as_of: str = ""
    certainty: Certainty = ""


def provisions_of(rulebook: Rulebook) -> tuple[ListedProvision, ...]:
    """The articles that a rulebook lists, in their order."""
    citing: dict[str, list[str]] = {}
    listed = _listed(rulebook.provisions)
    for rule in _own(rulebook):
        for number in dict.fromkeys(_cited(rule, listed)):
            citing.setdefault(number, []).append(rule.name)
    return tuple(
        ListedProvision(
            article.number,
            article.heading,
            "covered" if article.number in citing else article.treatment,
            tuple(citing.get(article.number, ())),
            "" if article.number in citing else article.because,
            link=article.link,
            as_of=article.as_of,
            certainty=article.certainty,
        )
        for article in rulebook.provisions
    )


def unlisted(rulebook: Rulebook) -> Iterator[tuple[str, str]]:
    """Rules with citations that are missing from the rulebook's list of articles, if it has one."""
    listed = _listed(rulebook.provisions)
    articles = {reference.kind for _, reference in listed if reference is not None}
    for rule in _own(rulebook) if listed else ():
        if any(number in rule.cite for number, reference in listed if reference is None):
            continue
        for reference in each_reference(rule.cite, _known(listed)):
            if reference.kind in articles and not _covering(reference, listed):
                yield rule.name, str(reference)


def _own(rulebook: Rulebook) -> list[Rule]:
    return [rule for rule in rulebook.rules if not rule.inherited_from]


Listed = Sequence[tuple[str, Reference | None]]
"""The articles as listed, with the place that each text names; None for a name of its own."""


def _listed(provisions: Sequence[Provision]) -> Listed:
    return [(article.number, article_listed(article.number)) for article in provisions]


def _known(listed: Listed) -> frozenset[tuple[str, str]]:
    return frozenset(
        (reference.kind, reference.number) for _, reference in listed if reference is not None
    )


def _cited(rule: Rule, listed: Listed) -> Iterator[str]:
    yield from (number for number, reference in listed if reference is None and number in rule.cite)
    of_its_year = [entry for entry in listed if _year(entry[0]) in rule.cite]
    for reference in each_reference(rule.cite, _known(listed)):
        yield from _covering(reference, of_its_year)[:1]


def _year(number: str) -> str:
    """The year after an article's number, as in `reg. 6 (1989)`; empty if there is none."""
    match = re.search(r"\((?:19|20)\d\d\)$", number)
    return match[0] if match else ""


def _covering(cited: Reference, listed: Listed) -> list[str]:
    """The listed articles that contain a cited place, the most specific first."""
    fitting = [
        (len(reference.parts), number)
        for number, reference in listed
        if reference is not None and covers(reference, cited)
    ]
    return [number for _, number in sorted(fitting, key=lambda entry: -entry[0])]
