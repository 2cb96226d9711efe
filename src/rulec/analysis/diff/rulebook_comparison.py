"""Comparison of two rulebooks rule by rule."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from rulec.analysis.believable_states import declarations_read
from rulec.analysis.diff.meanings_apart import with_words_apart
from rulec.analysis.diff.rule_comparison import RuleComparison, RuleRelation, compare
from rulec.analysis.lineage.rule_lineage import BookLineage, ConstantHistory, ConstantKind
from rulec.analysis.shared_compilation import at_one_step, compile_shared
from rulec.analysis.shared_vocabulary import shared_vocabulary
from rulec.analysis.trace_display import TraceTable, special_types, trace_table
from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.logic.free_names import names_in
from rulec.rulebook.files.edition_names import edition_names
from rulec.rulebook.rulebook_model import Remark, Rule, Rulebook, cited_law
from rulec.trace import Trace
from rulec.value_display import Rows, short_repr

ALIKE = Fraction(1, 2)
"""The least share of common words for which a rule of another name is suggested."""

MOST_ALIKE = 2


@dataclass(frozen=True, slots=True)
class RulePair:
    """A rule of both rulebooks: its two versions, compiled, and their comparison."""

    __repr__ = short_repr

    first: Rule
    second: Rule
    machines: tuple[CompiledRule, CompiledRule]
    comparison: RuleComparison

    @property
    def name(self) -> str:
        """The name of the rule in both rulebooks, or both names."""
        first, second = self.first.name, self.second.name
        return first if first == second else f"{first} = {second}"

    @property
    def relation(self) -> RuleRelation:
        """The relation of the first rule to the second."""
        return self.comparison.relation

    @property
    def notes(self) -> tuple[tuple[str, str, str], ...]:
        """Further differences: the field, and its value in each rulebook."""
        pairs = (
            (name, _noted(self.first, self.second, name), _noted(self.second, self.first, name))
            for name in ("strength", "level", "weight", "cite", "certainty")
        )
        return tuple((name, first, second) for name, first, second in pairs if first != second)


def _noted(rule: Rule, other: Rule, name: str) -> str:
    # The provision of a book is not repeated for a book that extends it.
    if name == "cite" and (rule.cite, rule.inherited_from) != (other.cite, other.book):
        return cited_law(rule.cite, rule.inherited_from) or "none"
    return str(getattr(rule, name)) or "none"


@dataclass(frozen=True, slots=True)
class OneSided:
    """A rule of only one rulebook, with the other's ``remark`` about it.

    ``alike`` are rules that only the other one has and that read mostly the same words, nearest
    first.
    """

    rule: Rule
    remark: Remark | None
    alike: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class SettingPair:
    """An option or parameter with a different value in each rulebook, as written."""

    kind: ConstantKind
    name: str
    first: str
    second: str


@dataclass(frozen=True, slots=True)
class RulebookDiff(Rows):
    """The differences between two rulebooks; ``files`` are those that they were read from."""

    __repr__ = short_repr

    first: Rulebook
    second: Rulebook
    pairs: tuple[RulePair, ...]
    only_first: tuple[OneSided, ...]
    only_second: tuple[OneSided, ...]
    settings: tuple[SettingPair, ...] = ()
    files: tuple[str, ...] = field(default=(), compare=False)

    @property
    def is_none(self) -> bool:
        """Whether both rulebooks forbid the same traces with the same strength."""
        alike = all(
            pair.relation == "equal" and pair.first.strength == pair.second.strength
            for pair in self.pairs
        )
        return alike and not self.only_first and not self.only_second

    @property
    def is_complete(self) -> bool:
        """Whether every question has been answered."""
        return not any(pair.comparison.undecided for pair in self.pairs)

    @property
    def witnesses(self) -> Iterator[Trace]:
        """The traces that one of them forbids and the other one allows."""
        for pair in self.pairs:
            yield from pair.comparison.first_forbids
            yield from pair.comparison.second_forbids

    def tables(self, pair: RulePair) -> Iterator[tuple[str, str, TraceTable]]:
        """For each trace, the names of the forbidding and the allowing rulebook, and its table."""
        if not (pair.comparison.first_forbids or pair.comparison.second_forbids):
            return  # perhaps since the two have no vocabulary in common
        words = shared_vocabulary(self.first.vocabulary, self.second.vocabulary)
        names = declarations_read(pair.machines[0]) | declarations_read(pair.machines[1])
        books = self.first.name, self.second.name
        for traces, (forbids, allows) in (
            (pair.comparison.first_forbids, books),
            (pair.comparison.second_forbids, books[::-1]),
        ):
            for trace in traces:
                types = special_types(trace, pair.machines) | _of_two_types(trace, pair)
                yield forbids, allows, trace_table(trace, names, words.vocabulary, types)

    def rows(self) -> list[dict[str, Any]]:
        """One row per rule, whether both rulebooks have it or only one."""
        both = [(pair.relation, pair.first, pair.second) for pair in self.pairs]
        first = [(f"only in {self.first.name}", only.rule, None) for only in self.only_first]
        second = [(f"only in {self.second.name}", None, only.rule) for only in self.only_second]
        return [
            {
                "rule": rule.name,
                "relation": relation,
                "strength 1": left.strength if left else "",
                "strength 2": right.strength if right else "",
                "cite 1": cited_law(left.cite, left.inherited_from) if left else "",
                "cite 2": cited_law(right.cite, right.inherited_from) if right else "",
            }
            for relation, left, right in (*both, *first, *second)
            if (rule := left or right)
        ]


def _of_two_types(trace: Trace, pair: RulePair) -> dict[str, str]:
    """The types of objects for which the two rules declare variables of different types."""
    ours, theirs = (
        {variable.name: variable.type for variable in rule.variables}
        for rule in (pair.first, pair.second)
    )
    return {
        name: kind
        for name, kind in trace.objects.items()
        if ours.get(name, kind) != theirs.get(name, kind)
    }


def setting_pairs(first: BookLineage, second: BookLineage) -> tuple[SettingPair, ...]:
    """The options and parameters that both have with different values."""
    others = {(constant.kind, constant.name): constant for constant in second.provisions}
    pairs = []
    for ours in first.provisions:
        theirs = others.get((ours.kind, ours.name))
        if ours.kind != "definition" and theirs and _value(ours) != _value(theirs):
            pairs.append(SettingPair(ours.kind, ours.name, _value(ours), _value(theirs)))
    return tuple(pairs)


def _value(provision: ConstantHistory) -> str:
    return next((value.text for value in provision.settings if value.current), "")


def diff_rulebooks(
    first: Rulebook,
    second: Rulebook,
    patterns: Sequence[str] = (),
    step_s: Fraction | None = None,
    tell: Callable[[float], object] = lambda _: None,
    *,
    most: int = 1,
    paired: Mapping[str, str] = MappingProxyType({}),
) -> RulebookDiff:
    """Compare the rules that two rulebooks share by name, or that are ``paired``.

    Args:
        first: a rulebook.
        second: the rulebook to compare it with.
        patterns: only rules whose name matches one of them, with wildcards ``*`` and ``?``.
        step_s: the step of traces for comparing rules with bounds in seconds; by default one that
            divides the steps of their examples.
        tell: called with the number of rules compared so far.
        most: the number of traces to search in each direction, each for a different reason.
        paired: maps rules of the first to rules of the second that have another name.

    Raises RulecError if a rule cannot be compiled.
    """
    first, second = with_words_apart(*with_distinct_names((first, second)))
    ours, theirs = (rules_matching(book, patterns) for book in (first, second))
    others = {rule.name: rule for rule in second.rules}
    partners = {name: theirs[name] for name in theirs if name in ours and name not in paired}
    partners = {name: rule for name, rule in partners.items() if name not in {*paired.values()}} | {
        name: others[paired[name]] for name in ours if name in paired
    }
    shared = [name for name in ours if name in partners]
    pairs = {name: at_one_step((ours[name], partners[name]), step_s) for name in shared}
    sides = compile_shared(
        (first, second), [{name: pairs[name][which] for name in shared} for which in (0, 1)]
    )
    compared = []
    for number, name in enumerate(shared, 1):
        left, right = sides[0][name], sides[1][name]
        compared.append(
            RulePair(
                ours[name],
                partners[name],
                (left.rule, right.rule),
                _labelled(compare(left, right, most), first.name, second.name, name),
            )
        )
        tell(number)
    met = {rule.name for rule in partners.values()}
    alone = [rule for name, rule in ours.items() if name not in partners]
    others_alone = [rule for name, rule in theirs.items() if name not in met]
    return RulebookDiff(
        first,
        second,
        tuple(compared),
        _only(alone, others_alone, second.remarks),
        _only(others_alone, alone, first.remarks),
    )


def rules_matching(book: Rulebook, patterns: Sequence[str]) -> dict[str, Rule]:
    """A rulebook's rules by name, only those that match one of the patterns (if any)."""
    return {
        rule.name: rule
        for rule in book.rules
        if not patterns or any(fnmatchcase(rule.name, pattern) for pattern in patterns)
    }


def _only(
    ours: Sequence[Rule], theirs: Sequence[Rule], remarks: Sequence[Remark]
) -> tuple[OneSided, ...]:
    remark_on = {remark.name: remark for remark in remarks if remark.kind != "softened"}
    words = {other.name: set(names_in(other.formula)) for other in theirs}
    return tuple([OneSided(rule, remark_on.get(rule.name), _alike(rule, words)) for rule in ours])


def _alike(rule: Rule, others: Mapping[str, set[str]]) -> tuple[str, ...]:
    """The names of rules that share at least half of the words that either of the two reads."""
    words = set(names_in(rule.formula))
    shares = {}
    for name, theirs in others.items():
        share = Fraction(len(words & theirs), max(1, len(words | theirs)))
        if share >= ALIKE:
            shares[name] = share
    return tuple(sorted(shares, key=lambda name: -shares[name])[:MOST_ALIKE])


def _labelled(comparison: RuleComparison, first: str, second: str, rule: str) -> RuleComparison:
    def named(traces: Sequence[Trace], forbids: str, allows: str) -> tuple[Trace, ...]:
        title = f"{rule}: {forbids} forbids, {allows} allows"
        return tuple(
            replace(trace, id=title if number == 1 else f"{title} ({number})")
            for number, trace in enumerate(traces, 1)
        )

    return replace(
        comparison,
        first_forbids=named(comparison.first_forbids, first, second),
        second_forbids=named(comparison.second_forbids, second, first),
    )


def with_distinct_names(books: Sequence[Rulebook]) -> list[Rulebook]:
    """The rulebooks, those of one name with their files, or else numbers, after it."""
    names = edition_names([book.name for book in books], [_own_file(book) for book in books])
    return [
        book if book.name == name else replace(book, name=name)
        for book, name in zip(books, names, strict=True)
    ]


def _own_file(book: Rulebook) -> str:
    """The file of a rule that the rulebook has of its own; empty if there is none."""
    spans = (rule.span for rule in book.rules if rule.book == book.name)
    return next((span.source.name for span in spans if span is not None), "")
