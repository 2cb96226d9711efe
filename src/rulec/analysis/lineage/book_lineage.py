"""Trace a rulebook's items to the books that introduced or changed them.

``rulebook.overlay`` says what a chain comes to; here is the way there. Both read the same trees,
and this one expects that the overlay has found no mistake in them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath

from rulec.analysis.lineage.rule_lineage import (
    BookHeader,
    BookLineage,
    ConstantHistory,
    ConstantValue,
    LineageStep,
    RuleHistory,
)
from rulec.rulebook.loader import Loaded, read_rulebook
from rulec.rulebook.names.doc_comments import description
from rulec.rulebook.names.referenced_names import names_used
from rulec.rulebook.overlay.constants_and_macros import in_force
from rulec.rulebook.overlay.rulebook_overlay import merged
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_formula


def book_lineage_of(chain: Sequence[tree.File], at: str) -> BookLineage:
    """The lineage of rules and provisions in a chain of sound rulebooks.

    Args:
        chain: their trees, the most general first.
        at: the day (ISO) whose law it is; it decides which value of a parameter counts.
    """
    history = _ChainHistory()
    for level, file in enumerate(chain):
        book = book_header(file).name
        for item in file.items:
            history.take(item, book, level)
    used = _used(history)
    return BookLineage(
        tuple(map(book_header, chain)),
        tuple(RuleHistory(name, tuple(steps)) for name, steps in history.rules.items()),
        tuple(
            replace(_provision(name, given, at), used=name in used)
            for name, given in history.provisions.items()
        ),
    )


def read_with_lineage(
    reference: str | Path, search_path: Sequence[str | Path] = (), at: str = ""
) -> tuple[Loaded, BookLineage]:
    """A rulebook, and where everything in it comes from. As for ``load_rulebook``."""
    loaded = read_rulebook(reference, search_path, at)
    return loaded, book_lineage_of(loaded.books, loaded.rulebook.at)


def _used(history: _ChainHistory) -> set[str]:
    """The provisions that rules use, directly or through other provisions."""
    used: set[str] = set()
    open_: list[tree.Item] = [rule for steps in history.rules.values() if (rule := steps[-1].rule)]
    while open_:
        names = set(names_used(open_.pop())) & history.provisions.keys()
        open_ += [item for name in names - used for item, _, _ in history.provisions[name]]
        used |= names
    return used


def book_header(file: tree.File) -> BookHeader:
    """The head of a rulebook: name, title, law, file and base."""
    return BookHeader(
        file.name.text if file.name else "",
        title=file.title.text.value if file.title else "",
        law=file.law.text.value if file.law else "",
        as_of=file.law.as_of if file.law else "",
        file=PurePath(file.span.source.name).name,
        extends=file.extends.name.text if file.extends else "",
    )


_Given = tree.OptionItem | tree.ParamItem | tree.SetItem | tree.DefineItem


@dataclass(slots=True)
class _ChainHistory:
    """The history of a chain so far.

    Of a provision it has the book and the book's number in the chain.
    """

    rules: dict[str, list[LineageStep]] = field(default_factory=dict)
    provisions: dict[str, list[tuple[_Given, str, int]]] = field(default_factory=dict)

    def take(self, item: tree.Item, book: str, level: int) -> None:
        match item:
            case tree.RuleItem(override=False):
                self._note(item.name, LineageStep(book, "declared", item))
            case tree.RuleItem():
                before = self._rule(item.name)
                after = merged(before, item)
                changed = tuple(changed_clauses(before, after))
                self._note(item.name, LineageStep(book, "overridden", after, changed))
            case tree.SoftenItem(name, level_name, weight, because):
                before = self._rule(name)
                after = replace(
                    before,
                    strength="soft",
                    level=level_name or before.level,
                    weight=weight or before.weight,
                )
                changed = tuple(changed_clauses(before, after))
                why = because.value if because else ""
                self._note(name, LineageStep(book, "softened", after, changed, why))
            case tree.DropItem(name, because):
                self._note(name, LineageStep(book, "dropped", None, (), because.value))
            case tree.SilentItem(name, because):
                self._note(name, LineageStep(book, "silent", None, (), because.value))
            case tree.OptionItem() | tree.ParamItem() | tree.SetItem() | tree.DefineItem():
                self.provisions.setdefault(item.name.text, []).append((item, book, level))
            case _:
                return

    def _note(self, name: tree.Name, step: LineageStep) -> None:
        self.rules.setdefault(name.text, []).append(step)

    def _rule(self, name: tree.Name) -> tree.RuleItem:
        rule = self.rules[name.text][-1].rule
        assert rule is not None, "nobody changes a rule that is gone"
        return rule


HARDNESS = "hard or soft"
"""What the word before ``rule`` is called among the clauses."""

_CLAUSES = {
    "strength": HARDNESS,
    "variables": "variables",
    "level": "level",
    "weight": "weight",
    "cite": "cite",
    "says": "says",
    "source": "source",
    "certainty": "certainty",
    "in_force": "in force",
    "require": "require",
    "when": "when",
    "unless": "unless",
    "examples": "examples",
}
"""Field of a rule's tree -> what it is called."""


def changed_clauses(before: tree.RuleItem, after: tree.RuleItem) -> Iterator[str]:
    """The kinds of clauses in which two rules differ, whatever their spelling."""
    for name, spoken in _CLAUSES.items():
        if getattr(before, name) != getattr(after, name):
            yield spoken


def _provision(name: str, given: Sequence[tuple[_Given, str, int]], at: str) -> ConstantHistory:
    first = given[0][0]
    current = _current(given, at)
    settings = tuple(
        ConstantValue(
            book,
            _text(item),
            *_dates(item),
            current=index == current,
            note=description(item.span),
        )
        for index, (item, book, _) in enumerate(given)
    )
    match first:
        case tree.OptionItem():
            return ConstantHistory("option", name, name, settings)
        case tree.DefineItem(parameters=parameters):
            shown = (
                f"{parameter.name.text}: {parameter.type.text}"
                if parameter.type
                else parameter.name.text
                for parameter in parameters
            )
            head = f"{name}({', '.join(shown)})" if parameters else name
            return ConstantHistory("definition", name, head, settings)
        case _:
            return ConstantHistory("parameter", name, name, settings)


def _current(given: Sequence[tuple[_Given, str, int]], at: str) -> int | None:
    """The index of the nearest book's item in force, or None."""
    good = [index for index, (item, _, _) in enumerate(given) if in_force(_when(item), at)]
    return max(good, key=lambda index: (given[index][2], index), default=None)


def _when(item: _Given) -> tree.InForce | None:
    return item.in_force if isinstance(item, tree.ParamItem | tree.SetItem) else None


def _dates(item: _Given) -> tuple[str, str]:
    dates = _when(item)
    return ("", "") if dates is None else (dates.since, dates.until)


def _text(item: _Given) -> str:
    body = item.body if isinstance(item, tree.DefineItem) else item.value
    if isinstance(body, bool):
        return "on" if body else "off"
    return print_formula(body, "written")
