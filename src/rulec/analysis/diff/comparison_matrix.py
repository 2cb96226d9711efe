"""Comparison of many rulebooks rule by rule: which have equal laws, and which are stricter."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import permutations
from pathlib import Path
from string import ascii_uppercase

from rulec.analysis.diff.distinct_names import with_distinct_names
from rulec.analysis.diff.rule_comparison import RuleRelation, rule_relation
from rulec.analysis.diff.rulebook_comparison import rules_matching
from rulec.analysis.shared_compilation import AnalyzedRule, at_one_step, compile_shared
from rulec.diagnostics import SourceLocation
from rulec.diagnostics.diagnostic import at
from rulec.resource_limits import COMPARISONS
from rulec.resources import rulebooks_folder
from rulec.rulebook.rulebook_model import Remark, Rule, Rulebook

CONVERSE: Mapping[RuleRelation, RuleRelation] = {
    "equal": "equal",
    "stricter": "laxer",
    "laxer": "stricter",
    "incomparable": "incomparable",
    "undecided": "undecided",
}
"""The relation of the second rule to the first, given that of the first to the second."""


@dataclass(frozen=True, slots=True)
class SharedRule:
    """A rule in all rulebooks that have one of its name.

    ``laws`` has the number of the law for each of these rulebooks, ``rules`` the rule itself;
    rulebooks with the same law forbid the same traces. ``relations`` are between laws, in both
    directions. ``remarks`` are by the rulebooks that explain why they do not have the rule.
    """

    name: str
    laws: Mapping[str, int]
    rules: Mapping[str, Rule]
    relations: Mapping[tuple[int, int], RuleRelation]
    remarks: Mapping[str, Remark]

    def letter(self, book: str) -> str:
        """The letter of a rulebook's law, ``A`` for the first one; empty if it lacks the rule."""
        law = self.laws.get(book)
        if law is None:
            return ""
        turns, rest = divmod(law, len(ascii_uppercase))
        return ascii_uppercase[rest] + (str(turns) if turns else "")

    def relation(self, first: str, second: str) -> RuleRelation | None:
        """The relation between two rulebooks' rules; None if one lacks the rule."""
        if first not in self.laws or second not in self.laws:
            return None
        return self.relations[self.laws[first], self.laws[second]]


@dataclass(frozen=True, slots=True)
class ComparisonMatrix:
    """Several rulebooks, and all their rules in order of first appearance."""

    books: tuple[Rulebook, ...]
    rules: tuple[SharedRule, ...]

    @property
    def shared(self) -> tuple[SharedRule, ...]:
        """The rules that at least two of the rulebooks have."""
        return tuple(rule for rule in self.rules if len(rule.laws) > 1)

    def counts(self, first: str, second: str) -> Counter[str]:
        """The number of the first rulebook's rules by their relation to the second's.

        ``only`` counts those that the second lacks, ``silent`` those among them for which it gives
        a reason.
        """
        numbers: Counter[str] = Counter()
        for rule in self.rules:
            relation = rule.relation(first, second)
            if relation is not None:
                numbers[relation] += 1
            elif first in rule.laws:
                numbers["only"] += 1
                numbers["silent"] += second in rule.remarks
        return numbers

    @property
    def is_complete(self) -> bool:
        """Whether every question has been answered."""
        return all("undecided" not in rule.relations.values() for rule in self.rules)

    @property
    def is_uniform(self) -> bool:
        """Whether every rule is equal in all rulebooks that have it."""
        return all(len(set(rule.laws.values())) == 1 for rule in self.rules)


def comparison_matrix(
    books: Sequence[Rulebook],
    patterns: Sequence[str] = (),
    step_s: Fraction | None = None,
    tell: Callable[[float], object] = lambda _: None,
) -> ComparisonMatrix:
    """Compare each pair of the rulebooks, rule by rule.

    The arguments are as for ``diff_rulebooks``; ``tell`` is called with the progress out of
    ``steps``. Raises RulecError, R0718 beyond the limit `comparisons`.
    """
    books = with_distinct_names(books)
    ours = [rules_matching(book, patterns) for book in books]
    having: dict[str, list[int]] = {}
    for number, rules in enumerate(ours):
        for name in rules:
            having.setdefault(name, []).append(number)
    _refuse_too_many(ours, having)
    stepped: list[dict[str, Rule]] = [{} for _ in books]
    for name, numbers in having.items():
        if len(numbers) > 1:
            same_step = at_one_step([ours[number][name] for number in numbers], step_s)
            for number, rule in zip(numbers, same_step, strict=True):
                stepped[number][name] = rule
    sides = compile_shared(books, stepped, tell)
    shared_rules = []
    for name, numbers in having.items():
        laws, relations = _classified(
            {books[number].name: sides[number][name] for number in numbers if len(numbers) > 1}
        )
        remarks = {
            book.name: remark
            for book in books
            for remark in book.remarks
            if remark.name == name and remark.kind != "softened"
        }
        versions = {books[number].name: ours[number][name] for number in numbers}
        # A rule that only one rulebook has forms its own law.
        laws = laws or dict.fromkeys(versions, 0)
        shared_rules.append(SharedRule(name, laws, versions, relations, remarks))
        tell(len(books) + len(shared_rules))
    return ComparisonMatrix(tuple(books), tuple(shared_rules))


def _refuse_too_many(
    ours: Sequence[Mapping[str, Rule]], having: Mapping[str, Sequence[int]]
) -> None:
    """Raise RulecError R0718 if there are too many pairs.

    It is at the rule that most rulebooks have, in the first of them that does not ship with rulec,
    since its author can do something about it.
    """
    amount = sum(len(numbers) * (len(numbers) - 1) // 2 for numbers in having.values())
    if amount <= COMPARISONS.value():
        return
    places = {
        name: [at(ours[number][name].span) for number in numbers]
        for name, numbers in having.items()
        if len(numbers) > 1
    }
    own = {name: written for name in places if (written := [*filter(_is_own, places[name])])}
    name = max(own or places, key=lambda name: len(places[name]))
    whose = f"{len(ours)} rulebooks, {len(places[name])} of which have `{name}`"
    COMPARISONS.within(amount, (own or places)[name][0], whose)


def _is_own(place: SourceLocation | None) -> bool:
    """Whether a place is in a file that does not ship with rulec."""
    return place is not None and rulebooks_folder() not in Path(place.file).parents


def steps(books: Sequence[Rulebook], patterns: Sequence[str] = ()) -> int:
    """The greatest number of progress steps."""
    return len(books) + len({name for book in books for name in rules_matching(book, patterns)})


def _classified(
    sides: Mapping[str, AnalyzedRule],
) -> tuple[dict[str, int], dict[tuple[int, int], RuleRelation]]:
    known: dict[int, int] = {}
    representatives: list[AnalyzedRule] = []
    relations: dict[tuple[int, int], RuleRelation] = {}
    for side in sides.values():
        if side.law in known:
            continue
        compared: list[RuleRelation] = []
        while "equal" not in compared and len(compared) < len(representatives):
            compared.append(rule_relation(side, representatives[len(compared)]))
        if "equal" in compared:
            known[side.law] = len(compared) - 1
            continue
        own = known[side.law] = len(representatives)
        representatives.append(side)
        relations[own, own] = "equal"
        for number, relation in enumerate(compared):
            relations[own, number] = relation
            relations[number, own] = CONVERSE[relation]
    return {book: known[side.law] for book, side in sides.items()}, relations


def pairs(books: Sequence[Rulebook]) -> list[tuple[str, str]]:
    """All pairs of rulebooks, in both orders."""
    return [(first.name, second.name) for first, second in permutations(books, 2)]
