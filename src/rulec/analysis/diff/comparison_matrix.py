"""Comparison of many rulebooks rule by rule: which have equal laws, and which are stricter."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from string import ascii_uppercase

from rulec.analysis.diff.meanings_apart import words_apart
from rulec.analysis.diff.rule_comparison import RuleRelation, rule_relation
from rulec.analysis.diff.rulebook_comparison import diff_rulebooks, rules_matching
from rulec.analysis.shared_compilation import AnalyzedRule, SharedCompiler, at_one_step
from rulec.diagnostics import SourceLocation
from rulec.diagnostics.diagnostic import at
from rulec.logic.free_names import names_of
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
        return tuple(rule for rule in self.rules if len(rule.rules) > 1)

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

    def without(self, names: Container[str]) -> ComparisonMatrix:
        """The matrix without rulebooks that share no rule with the others."""
        books = tuple(book for book in self.books if book.name not in names)
        rules = tuple(rule for rule in self.rules if any(name not in names for name in rule.laws))
        return ComparisonMatrix(books, rules)

    @property
    def is_complete(self) -> bool:
        """Whether every question has been answered."""
        return all("undecided" not in rule.relations.values() for rule in self.rules)

    @property
    def is_uniform(self) -> bool:
        """Whether every rule is equal in all rulebooks that have it."""
        return all(len(set(rule.laws.values())) == 1 for rule in self.rules)


def growing_matrices(
    books: Iterable[Rulebook], patterns: Sequence[str] = (), step_s: Fraction | None = None
) -> Iterator[ComparisonMatrix]:
    """The matrix of the first rulebook, of the first two, and so on, as each of them is read.

    Their names have to be distinct; the other arguments are as for ``diff_rulebooks``. A rule is
    compared at a step that suits it and the laws that are known by then. Raises RulecError, R0718
    beyond the limit `comparisons`.
    """
    laws = _LawsSoFar(step_s)
    matrix = ComparisonMatrix((), ())
    for book in books:
        matrix = _with_book(matrix, book, rules_matching(book, patterns))
        _refuse_too_many(matrix)
        matrix = laws.classified(matrix)
        yield matrix


def _with_book(
    matrix: ComparisonMatrix, book: Rulebook, own: Mapping[str, Rule]
) -> ComparisonMatrix:
    """The matrix with one more rulebook, and its rules, whose laws are not known yet."""
    books = (*matrix.books, book)
    remarks: dict[str, dict[str, Remark]] = {}
    for each in books:
        for remark in each.remarks:
            if remark.kind != "softened":
                remarks.setdefault(remark.name, {})[each.name] = remark
    known = {rule.name: rule for rule in matrix.rules}
    first = SharedRule("", {}, {}, {}, {})
    rules = []
    for name in dict.fromkeys((*known, *own)):
        before = known.get(name, first)
        versions = {**before.rules, book.name: own[name]} if name in own else before.rules
        rules.append(
            replace(before, name=name, rules=versions, remarks=remarks.get(name, before.remarks))
        )
    return ComparisonMatrix(books, tuple(rules))


@dataclass(slots=True)
class _LawsSoFar:
    """Compiled rules, by rulebook, name and step, and the relations between their laws."""

    step_s: Fraction | None
    books: dict[str, Rulebook] = field(default_factory=dict)
    compiler: SharedCompiler = field(default_factory=SharedCompiler)
    sides: dict[tuple[str, str, Fraction], AnalyzedRule] = field(default_factory=dict)
    relations: dict[tuple[int, int], RuleRelation] = field(default_factory=dict)

    def classified(self, matrix: ComparisonMatrix) -> ComparisonMatrix:
        """The matrix with the laws of the last rulebook's rules."""
        book = matrix.books[-1].name
        self.books[book] = matrix.books[-1]
        new = {rule.name: self._to_compare(rule, book) for rule in matrix.rules}
        self._compile(matrix.books, {name: rules for name, rules in new.items() if len(rules) > 1})
        rules = [
            self._with_law(rule, book, new[rule.name]) if book in rule.rules else rule
            for rule in matrix.rules
        ]
        return replace(matrix, rules=tuple(rules))

    def _to_compare(self, rule: SharedRule, book: str) -> dict[str, Rule]:
        """The first rule of each law and that of a rulebook, by rulebook, at one step."""
        if book not in rule.rules:
            return {}
        firsts: dict[int, str] = {}
        for name, law in rule.laws.items():
            firsts.setdefault(law, name)
        names = [*firsts.values(), book]
        same_step = at_one_step([rule.rules[name] for name in names], self.step_s)
        return dict(zip(names, same_step, strict=True))

    def _compile(
        self, books: Sequence[Rulebook], stepped: Mapping[str, Mapping[str, Rule]]
    ) -> None:
        for book in books:
            versions = {
                name: rules[book.name] for name, rules in stepped.items() if book.name in rules
            }
            missing = {
                name: rule
                for name, rule in versions.items()
                if (book.name, name, rule.step_s) not in self.sides
            }
            for name, side in self.compiler.compiled(book, missing).items() if missing else ():
                self.sides[book.name, name, missing[name].step_s] = side

    def _with_law(self, rule: SharedRule, book: str, versions: Mapping[str, Rule]) -> SharedRule:
        """The rule with the law of a rulebook, which is compared with the first of each law."""
        *earlier, _ = versions
        compared: list[RuleRelation] = []
        for name in earlier:
            step_s = versions[name].step_s
            ours, theirs = (self.sides[each, rule.name, step_s] for each in (book, name))
            pair = self.books[book], self.books[name]
            read = names_of(versions[book].formula) | names_of(versions[name].formula)
            if read & pair[0].vocabulary.meanings.keys() and read & words_apart(*pair):
                relation = diff_rulebooks(*pair, [rule.name], self.step_s).pairs[0].relation
            else:
                relation = self._relation(ours, theirs)
            if relation == "equal":
                return replace(rule, laws={**rule.laws, book: len(compared)})
            compared.append(relation)
        own = len(compared)
        relations: dict[tuple[int, int], RuleRelation] = {**rule.relations, (own, own): "equal"}
        for number, relation in enumerate(compared):
            relations[own, number] = relation
            relations[number, own] = CONVERSE[relation]
        return replace(rule, laws={**rule.laws, book: own}, relations=relations)

    def _relation(self, first: AnalyzedRule, second: AnalyzedRule) -> RuleRelation:
        laws = first.law, second.law
        if laws not in self.relations:
            self.relations[laws] = rule_relation(first, second)
        return self.relations[laws]


def _refuse_too_many(matrix: ComparisonMatrix) -> None:
    """Raise RulecError R0718 if there are too many pairs.

    It is at the rule that most rulebooks have, in the first of them that does not ship with rulec,
    since its author can do something about it.
    """
    amount = sum(len(rule.rules) * (len(rule.rules) - 1) // 2 for rule in matrix.rules)
    if amount <= COMPARISONS.value():
        return
    places = {
        rule.name: [at(version.span) for version in rule.rules.values()] for rule in matrix.shared
    }
    own = {name: written for name in places if (written := [*filter(_is_own, places[name])])}
    name = max(own or places, key=lambda name: len(places[name]))
    whose = f"{len(matrix.books)} rulebooks, {len(places[name])} of which have `{name}`"
    COMPARISONS.within(amount, (own or places)[name][0], whose)


def _is_own(place: SourceLocation | None) -> bool:
    """Whether a place is in a file that does not ship with rulec."""
    return place is not None and rulebooks_folder() not in Path(place.file).parents
