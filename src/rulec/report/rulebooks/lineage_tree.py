"""Lineages of rulebook items and forests of extensions, as trees and JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from io import StringIO

from rich.console import Console
from rich.text import Text
from rich.tree import Tree

from rulec.analysis.lineage import rule_lineage
from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled
from rulec.report.rulebooks.document_language import provenance
from rulec.report.text.terminal_text import broken, column_lines, cut, visible
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_in_force

_DEEDS = {
    "declared": "declared by",
    "overridden": "overridden by",
    "confirmed": "confirmed by",
    "softened": "softened by",
    "dropped": "dropped by",
    "silent": "passed over in silence by",
}


_TITLES = {
    "confirmed": "confirmed",
    "overridden": "overridden",
    "declared": "own",
    "softened": "softened",
    "dropped": "dropped",
    "silent": "silent",
    "": "only inherited",
}
"""What a book itself has done with a rule, nothing last, as an overview calls it."""

MOST_LINES = 38
"""The most lines of an overview, so that it fits on a screen."""


class LineageStepData(JsonPart, frozen=True, kw_only=True):
    """A rulebook's change to a rule in the chain."""

    book: str
    deed: rule_lineage.LineageAction
    clauses: Sequence[str]
    because: str
    lost: Sequence[str]


class RuleLineageData(JsonPart, frozen=True, kw_only=True):
    """A rule's history from its declaration, perhaps to its removal.

    ``inherited_from`` names the rulebook that it comes from, if the last one has not confirmed it.
    """

    name: str
    gone: bool
    steps: Sequence[LineageStepData]
    inherited_from: str


class LineageDocument(JsonDocument, frozen=True, kw_only=True):
    """A rulebook's chain, the most general rulebook first, its rules and provisions."""

    rulebook: str
    books: Sequence[rule_lineage.BookHeader]
    rules: Sequence[RuleLineageData]
    provisions: Sequence[rule_lineage.ConstantHistory]


class ForestDocument(JsonDocument, frozen=True, kw_only=True):
    """Every rulebook, each after the one that it extends."""

    books: Sequence[rule_lineage.BookHeader]


def chosen(
    inherited: rule_lineage.BookLineage, patterns: Sequence[str]
) -> rule_lineage.BookLineage:
    """The lineage of the rules that match one of the patterns; without patterns, everything."""
    if not patterns:
        return inherited
    rules = tuple(
        rule
        for rule in inherited.rules
        if any(fnmatchcase(rule.name, pattern) for pattern in patterns)
    )
    return rule_lineage.BookLineage(inherited.books, rules, ())


def as_text(inherited: rule_lineage.BookLineage, width: int, *, color: bool) -> str:
    """The chain, the most general rulebook first, then its rules and provisions."""
    first, *others = inherited.books
    chain = below = Tree(_book(first))
    for book in others:
        below = below.add(_book(book))
    trees = [chain]
    if inherited.rules:
        rules = Tree(Text("rules", "bold"))
        for rule in inherited.rules:
            _rule(rule, inherited, rules)
        trees.append(rules)
    for kind in ("option", "parameter", "definition"):
        provisions = Tree(Text(f"{kind}s", "bold"))
        for constant_history in inherited.provisions:
            if constant_history.kind == kind:
                _provision(constant_history, inherited.book, provisions)
        trees += [provisions] if provisions.children else []
    return "\n\n".join(_drawn(tree_, width, color=color) for tree_ in trees)


def as_overview(inherited: rule_lineage.BookLineage, width: int) -> str:
    """How many rules the last book of a chain has in which way, and a line for each it changed."""
    book = inherited.book
    by_deed: dict[str, list[rule_lineage.RuleHistory]] = {deed: [] for deed in _TITLES}
    for history in inherited.rules:
        by_deed[history.last.deed if history.last.book == book else ""].append(history)
    counts = [f"{len(found):,} {_TITLES[deed]}" for deed, found in by_deed.items() if found]
    chain = " ← ".join(header.name for header in inherited.books[::-1])
    lines = broken(visible(f"{chain}: {' · '.join(counts) or 'no rules'}"), width, later="  ")
    packed = {"declared"}
    changed = [deed for deed in _TITLES if deed not in ("", "confirmed") and by_deed[deed]]
    for pack in ("", *changed):
        packed.add(pack)
        parts = [_changed(deed, by_deed[deed], width, deed in packed) for deed in changed]
        if sum(map(len, parts)) < MOST_LINES - len(lines):
            break
    set_here = [
        f"{constant.head} = {value.text}"
        for constant in inherited.provisions
        for value in constant.settings
        if value.book == book and value.current and constant.kind != "definition"
    ]
    lines += [line for part in parts for line in part]
    if set_here:
        lines.append(cut(visible(f"set: {', '.join(set_here)}"), width))
    return "\n".join([*lines, "`--all` shows every rule, option, parameter and definition"])


def _changed(
    deed: str, found: Sequence[rule_lineage.RuleHistory], width: int, packed: bool
) -> list[str]:
    """The rules that a book changed in one way: a line each, or packed into lines."""
    if packed:
        names = ", ".join(history.name for history in found)
        return broken(visible(f"{_TITLES[deed]}: {names}"), width, later="  ")
    rows = [
        (visible(history.name), visible(history.last.because or ", ".join(history.last.clauses)))
        for history in found
    ]
    return [_TITLES[deed], *column_lines(rows, width, indent="  ")]


def forest_as_text(
    branches: Sequence[rule_lineage.ExtensionTree], width: int, *, color: bool
) -> str:
    """A tree for each rulebook that extends no other."""
    return "\n".join(_drawn(_grown(branch), width, color=color) for branch in branches)


def _grown(branch: rule_lineage.ExtensionTree, above: Tree | None = None) -> Tree:
    label = _book(branch.book, missing=above is None)
    here = Tree(label) if above is None else above.add(label)
    for child in branch.children:
        _grown(child, here)
    return here


def _drawn(shown: Tree, width: int, *, color: bool) -> str:
    stream = StringIO()
    console = Console(
        file=stream, width=width, force_terminal=color, no_color=not color, highlight=False
    )
    console.print(shown)
    return "\n".join(line.rstrip() for line in stream.getvalue().splitlines())


def _book(book: rule_lineage.BookHeader, *, missing: bool = False) -> Text:
    label = Text(visible(book.name), "bold")
    if book.title:
        label.append(f"  {visible(book.title)}", "not bold")
    since = f", as of {book.as_of}" if book.as_of else ""
    details = [f"{book.law}{since}" if book.law else "", book.file]
    if missing and book.extends:
        details.append(f"extends {book.extends}, which is not here")
    for detail in filter(None, details):
        label.append(f"\n{visible(detail)}", "dim not bold")
    return label


def _rule(
    rule_history: rule_lineage.RuleHistory, inherited: rule_lineage.BookLineage, rules: Tree
) -> None:
    gone = rule_history.rule is None
    label = Text(visible(rule_history.name), "dim" if gone else "")
    label.append(
        f"  {visible(provenance(rule_history, inherited))}",
        "dim" if rule_history.last.book != inherited.book else "",
    )
    if rule_history.rule is not None and rule_history.rule.in_force is not None:
        label.append(f"  {print_in_force(rule_history.rule.in_force)}", "dim")
    here = rules.add(label)
    for exception in rule_history.last.lost:
        here.add(Text(f"without the inherited `{visible(exception)}`", "dim"))
    upon_one = ("overridden", "confirmed")
    is_one_override = len(rule_history.steps) == 2 and rule_history.last.deed in upon_one
    for step in () if is_one_override else rule_history.steps[:-1]:
        here.add(Text(f"{_DEEDS[step.deed]} {visible(step.book)}{_detail(step)}", "dim"))


def _detail(step: rule_lineage.LineageStep) -> str:
    changed = f": {', '.join(step.clauses)}" if step.clauses else ""
    return visible(f"{changed}{f', because {step.because}' if step.because else ''}")


def _provision(constant_history: rule_lineage.ConstantHistory, book: str, provisions: Tree) -> None:
    label = Text(visible(constant_history.head))
    here = provisions.add(label)
    for setting in constant_history.settings:
        dated = setting.since or setting.until
        dates = f" {print_in_force(tree.InForce(setting.since, setting.until))}" if dated else ""
        value = f"{setting.written}{dates}"
        origin = "own" if setting.book == book else f"from {setting.book}"
        origin += f", {setting.cite}" if setting.cite else ""
        if setting.current:
            label.append(visible(f" = {value}  "))
            label.append(visible(origin), "dim")
        else:
            here.add(Text(visible(f"{value}  {origin}"), "dim"))
    if not any(setting.current for setting in constant_history.settings):
        label.append("  no value in force", "dim")


def as_json(inherited: rule_lineage.BookLineage) -> str:
    """Write the chain, the rules' histories and the provisions."""
    rules = []
    for history in inherited.rules:
        law, gone = inherited.inherited_from(history), history.rule is None
        rules.append(filled(RuleLineageData, history, gone=gone, inherited_from=law))
    return as_indented(filled(LineageDocument, inherited, rulebook=inherited.book, rules=rules))


def forest_as_json(branches: Sequence[rule_lineage.ExtensionTree]) -> str:
    """Write every rulebook, each after the one that it extends."""
    return as_indented(ForestDocument(books=list(_members(branches))))


def _members(branches: Sequence[rule_lineage.ExtensionTree]) -> Iterator[rule_lineage.BookHeader]:
    for branch in branches:
        yield branch.book
        yield from _members(branch.children)
