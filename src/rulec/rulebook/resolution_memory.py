"""Results of a rulebook's last resolution that remain valid after an edit."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from operator import is_

from rulec.cancellation import step
from rulec.diagnostics import Diagnostic
from rulec.rulebook.loader import Trees, day_of, in_order
from rulec.rulebook.names.referenced_names import names_in_examples, names_used
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros
from rulec.rulebook.overlay.rulebook_overlay import Overlay, RuleEntry, overlay
from rulec.rulebook.resolve import (
    BookNames,
    TranslatedRule,
    is_whole,
    names_of,
    translated,
    with_rules,
)
from rulec.rulebook.rulebook_model import Rulebook
from rulec.syntax import tree

_Provision = tree.OptionItem | tree.ParamItem | tree.SetItem | tree.DefineItem


@dataclass(frozen=True, slots=True)
class ResolvedTrees:
    """Trees, the names their formulas can use, the rulebook if it has no error, and findings."""

    trees: Trees
    names: BookNames
    rulebook: Rulebook | None
    findings: tuple[Diagnostic, ...]


@dataclass(frozen=True, slots=True)
class _Known:
    """A translated rule, and the parts of trees from which it was made.

    ``provisions`` are those that its formulas use, also indirectly. ``certain``: no name was
    missing because of unreadable text.
    """

    own: tuple[object, ...]
    header: tuple[object, ...]
    provisions: tuple[object, ...]
    names: BookNames
    result: TranslatedRule
    certain: bool


@dataclass(slots=True)
class ResolutionMemory:
    """Resolves one rulebook's trees repeatedly while it is edited.

    Parts of trees are compared by identity: what an edit has not touched is the same object.
    """

    _asked: tuple[str, bool] = "", False
    _stable: tuple[object, ...] = ()
    _declared: tuple[object, ...] = ()
    _names: BookNames | None = None
    _rules: dict[str, _Known] = field(default_factory=dict)
    _used: dict[int, tuple[tree.Item, frozenset[str]]] = field(default_factory=dict)

    def resolved(self, trees: Trees, at: str = "") -> ResolvedTrees:
        """The result of ``resolve`` for trees.

        ``at`` is the day (ISO), as for ``read_rulebook``.
        """
        day = day_of(trees, at)
        files = (*trees.vocabularies, *trees.books)
        opaque = trees.dependencies is None
        stable, declared = _apart_from_rules(files)
        if (day, opaque) != self._asked or not _same(declared, self._declared):
            self._rules.clear()
            self._names = None
        if self._names is not None and _same(stable, self._stable):
            names = _with_rules_of(trees, self._names)
        else:
            names = names_of(trees.books, trees.vocabularies, opaque=opaque, at=day)
        self._asked, self._stable, self._declared = (day, opaque), stable, declared
        self._names = names
        changes = _by_rule(trees.books)
        kept: dict[str, _Known] = {}

        def translate(entry: RuleEntry, names: BookNames, confirmed: bool) -> TranslatedRule:
            step()
            name = entry.item.name.text
            kept[name] = self._translated(entry, names, tuple(changes[name]), confirmed=confirmed)
            return kept[name].result

        whole = not opaque and all(map(is_whole, files))
        rulebook, meanings = with_rules(trees.books, names, trees.sources, translate, whole=whole)
        self._rules = kept
        findings = in_order(trees.name, [*trees.mistakes, *meanings])
        if any(finding.severity == "error" for finding in findings):
            rulebook = None
        return ResolvedTrees(trees, names, rulebook, findings)

    def _translated(
        self, entry: RuleEntry, names: BookNames, own: tuple[object, ...], *, confirmed: bool
    ) -> _Known:
        known = self._rules.get(entry.item.name.text)
        header = (
            *(entry.book.name, entry.law.name, entry.examples_from.step, confirmed),
            names.constants.overlay.topics_of(entry.item),
        )
        provisions = self._provisions(entry.item, names.constants.overlay)
        if known is not None and known.header == header and _same(known.own, own):
            result = known.result
            # What a mistake says may depend on every name that there is.
            sound = not (result.mistakes or result.contradictions)
            is_clean = known.certain and sound and result.rule is not None
            same_facts = known.names.axioms == names.axioms
            same_provisions = same_facts and _same(known.provisions, provisions)
            if known.names.symbols is names.symbols or (is_clean and same_provisions):
                return replace(known, names=names)
        result = translated(entry, names, confirmed)
        return _Known(own, header, provisions, names, result=result, certain=_is_certain(names))

    def _provisions(self, rule: tree.RuleItem, laid: Overlay) -> tuple[object, ...]:
        """The options, parameters and definitions that a rule uses, in a fixed order."""
        provisions: dict[str, tuple[object, ...]] = {}
        waiting = set(self._names_used(rule))
        while waiting:
            name = waiting.pop()
            if name in provisions:
                continue
            items = _items_behind(name, laid)
            provisions[name] = (laid.options.get(name), *items)
            for item in items:
                waiting |= self._names_used(item) - provisions.keys()
        return tuple(part for name in sorted(provisions) for part in provisions[name])

    def _names_used(self, item: tree.Item) -> frozenset[str]:
        known = self._used.get(id(item))
        if known is None or known[0] is not item:
            if len(self._used) > 10_000:
                self._used.clear()
            in_examples = names_in_examples(item) if isinstance(item, tree.RuleItem) else ()
            known = self._used[id(item)] = (item, frozenset([*names_used(item), *in_examples]))
        return known[1]


def _is_certain(names: BookNames) -> bool:
    """Whether no name may be missing because of unreadable text."""
    symbols, laid = names.symbols, names.constants.overlay
    open_names = symbols.opaque or symbols.opaque_types or symbols.suspects
    return not (laid.unsure or laid.unsure_rules or laid.suspects or open_names)


def _items_behind(name: str, laid: Overlay) -> tuple[_Provision, ...]:
    if name in laid.definitions:
        return (laid.definitions[name],)
    return tuple(value.item for value in laid.parameters.get(name, ()))


def _same(parts: Sequence[object], others: Sequence[object]) -> bool:
    return len(parts) == len(others) and all(map(is_, parts, others))


def _apart_from_rules(
    files: Iterable[tree.File],
) -> tuple[tuple[object, ...], tuple[object, ...]]:
    """Everything except rules in files, split into what affects every rule and the rest.

    The rest only affects rules that visibly use it, or that do not depend on it without a mistake.
    """
    stable: list[object] = []
    declared: list[object] = []
    for file in files:
        declared += (file.span.source, *file.uses, file.extends, file.traffic, *file.priorities)
        stable += (file.complete, file.name, file.law)
        for item in file.items:
            if isinstance(item, tree.RuleItem | tree.SoftenItem | tree.DropItem):
                continue
            listing = isinstance(item, tree.TopicsItem | tree.ProvisionsItem)
            used = listing or isinstance(item, _Provision | tree.BrokenItem)
            (stable if used else declared).append(item)
    return (*stable, *declared), tuple(declared)


def _with_rules_of(trees: Trees, names: BookNames) -> BookNames:
    """The same names for other rules, which are applied to one another again."""
    symbols, old = names.symbols, names.constants
    spans = {**symbols.type_spans, **symbols.spans}
    laid = overlay((*trees.vocabularies, *trees.books), spans, unsure=old.overlay.unsure)
    constants = ConstantsAndMacros(
        laid, old.at, old.traffic, numbers=old.numbers, broken=old.broken
    )
    rest = names.mistakes[len(symbols.mistakes) + len(old.overlay.mistakes) :]
    return replace(names, constants=constants, mistakes=(*symbols.mistakes, *laid.mistakes, *rest))


def _by_rule(books: Iterable[tree.File]) -> dict[str, list[object]]:
    """Statements about each rule, by its name."""
    items: dict[str, list[object]] = {}
    for book in books:
        for item in book.items:
            if isinstance(item, tree.RuleItem | tree.SoftenItem | tree.DropItem | tree.SilentItem):
                items.setdefault(item.name.text, []).append(item)
    return items
