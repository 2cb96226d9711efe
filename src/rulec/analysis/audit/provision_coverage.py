"""Coverage of a law by a rulebook: the treatment of each article."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from rulec.analysis.audit.citations import Listed, cited_entries, listed_places, unlisted_places
from rulec.rulebook.rulebook_model import Certainty, Rule, Rulebook
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
    listed = _listed(rulebook)
    for rule in _own(rulebook):
        for number in dict.fromkeys(cited_entries(rule.cite, listed)):
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
    listed = _listed(rulebook)
    for rule in _own(rulebook) if listed else ():
        for place in unlisted_places(rule.cite, listed):
            yield rule.name, place


def _own(rulebook: Rulebook) -> list[Rule]:
    return [rule for rule in rulebook.rules if not rule.inherited_from]


def _listed(rulebook: Rulebook) -> Listed:
    return listed_places(article.number for article in rulebook.provisions)
