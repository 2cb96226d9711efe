"""Relevance filter: pairs of rules that share words, directly or through axioms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from rulec.analysis.believable_states import declarations_read
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.logic.free_names import names_in
from rulec.resource_limits import PAIRS


class RelatedRules:
    """Rules of one rulebook that share an input or are connected by axioms.

    Shared words are indexed, so unrelated pairs cost nothing. ``names`` are the rules in question,
    in the order in which findings are reported.

    Raises RulecError R0718 if the number of related pairs exceeds the limit `pairs`.
    """

    def __init__(self, names: Sequence[str], rules: Mapping[str, AnalyzedRule], book: str) -> None:
        self._place = {name: place for place, name in enumerate(names)}
        topics = _topics(rules[names[0]]) if names else {}
        self._topics = {
            name: {topics.get(word, word) for word in declarations_read(rules[name].rule)}
            for name in names
        }
        self._about: dict[str, list[str]] = {}
        for name, own in self._topics.items():
            for topic in own:
                self._about.setdefault(topic, []).append(name)
        sharing = sum(len(own) * (len(own) - 1) // 2 for own in self._about.values())
        first = rules[names[0]].rulebook.place_of(names[0]) if names else None
        PAIRS.within(sharing, first, f"rulebook `{book}`")

    def of(self, name: str) -> list[str]:
        """The other rules that a rule is related to, in order."""
        related = {other for topic in self._topics[name] for other in self._about[topic]}
        return sorted(related - {name}, key=self._place.__getitem__)

    def pairs(self) -> Iterator[tuple[str, str]]:
        """The pairs of related rules, in order."""
        for name, place in self._place.items():
            for other in self.of(name):
                if self._place[other] > place:
                    yield name, other


def _topics(analyzed: AnalyzedRule) -> dict[str, str]:
    """Maps each word to one representative of the words that axioms connect it with."""
    topic_of: dict[str, str] = {}
    words_of: dict[str, list[str]] = {}
    for axiom in analyzed.axioms:
        words = list(dict.fromkeys(names_in(axiom.formula)))
        topics = dict.fromkeys(topic_of.get(word, word) for word in words)
        for topic in topics:
            joined = words_of.pop(topic, [topic])
            words_of.setdefault(words[0], []).extend(joined)
            topic_of.update(dict.fromkeys(joined, words[0]))
    return topic_of
