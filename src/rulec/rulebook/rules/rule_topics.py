"""Rules by what they are about: topics, and the groups of shipped topics."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import groupby

from rulec.diagnostics import nearest_name
from rulec.rulebook.rulebook_model import Rulebook
from rulec.rulebook.vocabulary_phrases import synonyms_of_the_field, topic_groups

OTHER = "other"
"""The heading of rules without a topic."""


def by_group(books: Sequence[Rulebook]) -> dict[str, list[str]]:
    """The names of all rules below headings, each once, in the order of groups and of the books.

    A heading is the first group that has one of the rule's topics, else the title of its topic.
    """
    titles = {topic.name: topic.title for book in books for topic in book.topics}
    groups = {group.replace("_", " and "): topics for group, topics in topic_groups().items()}
    order = [*groups, *titles.values(), OTHER]
    places: dict[str, tuple[int, int, bool]] = {}
    for rule in (rule for book in books for rule in book.rules):
        heading, place = OTHER, 0
        for group, topics in groups.items():
            if own := [topics.index(topic) for topic in rule.topics if topic in topics]:
                heading, place = group, min(own)
                break
        else:
            heading = titles[rule.topics[0]] if rule.topics else OTHER
        places.setdefault(rule.name, (order.index(heading), place, rule.name not in rule.topics))
    names = sorted(places, key=lambda name: places[name])
    return {
        order[heading]: list(below)
        for heading, below in groupby(names, lambda name: places[name][0])
    }


def on_topic(books: Sequence[Rulebook], word: str) -> tuple[Rulebook, ...]:
    """The rulebooks with only their rules on a topic.

    The word is a group of topics, a topic, part of the name or title of some, or a synonym of it.

    Raises LookupError, which says what topics there are.
    """
    asked = "_".join(word.casefold().split())
    topics = {topic.name: topic.title for book in books for topic in book.topics}
    known = _topics_for(asked, topics)
    if not known:
        similar = [
            word
            for main, words in synonyms_of_the_field().items()
            if asked in words
            for word in (main, *words)
        ]
        # A crosswalk is a pedestrian crossing before it is part of a level crossing's title
        found = [_named(word, topics) for word in similar]
        found += [_topics_for(word, topics) for word in similar]
        known = next(filter(None, found), set())
    if not known:
        raise LookupError(_unknown(asked, topics))
    return tuple(
        replace(book, rules=tuple(rule for rule in book.rules if not known.isdisjoint(rule.topics)))
        for book in books
    )


def _topics_for(asked: str, topics: dict[str, str]) -> set[str]:
    named = _named(asked, topics)
    if named:
        return named
    words = {*map(_singular, asked.split("_"))}
    return {
        name
        for name, title in topics.items()
        if words <= {_singular(word) for word in (*name.split("_"), *_words(title))}
    }


def _named(asked: str, topics: dict[str, str]) -> set[str]:
    """The topics of the group, or the topic, that is called so, whether one or several."""
    groups = topic_groups()
    for group in groups:
        if _singular(group) == _singular(asked):
            return {*groups[group]} & topics.keys()
    return {name for name in topics if _singular(name) == _singular(asked)}


def _singular(word: str) -> str:
    return word.removesuffix("s")


def _words(title: str) -> Iterable[str]:
    return (word.strip(",:;.") for word in title.casefold().split())


def _unknown(asked: str, topics: dict[str, str]) -> str:
    groups = [name for name, below in topic_groups().items() if not topics.keys().isdisjoint(below)]
    near = nearest_name(asked, [*groups, *topics])
    there = ", ".join(f"`{name}`" for name in groups or topics) or "none"
    meant = f"; did you mean `{near}`?" if near else ""
    single = f"; single ones are such as `{next(iter(topics))}`" if groups else ""
    return f"there is no topic `{asked}`{meant}; there are {there}{single}"
