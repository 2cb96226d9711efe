"""Traces a rulebook's items to the books that introduced or changed them.

``rulebook.overlay`` computes the result of a chain; this module computes how it came about. Both
read the same trees, and this one assumes that the overlay found no mistakes in them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path, PurePath

from rulec.analysis.lineage import rule_lineage
from rulec.rulebook.loader import Trees, read_trees, resolve_trees
from rulec.rulebook.names.doc_comments import description
from rulec.rulebook.names.referenced_names import names_used
from rulec.rulebook.overlay.rule_override import CLAUSES, lost_exceptions, merged, softened
from rulec.rulebook.overlay.rulebook_overlay import in_force
from rulec.rulebook.rulebook_model import Loaded
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_formula, print_parameters

_Given = tree.OptionItem | tree.ParamItem | tree.SetItem | tree.DefineItem


def book_lineage_of(
    chain: Sequence[tree.File], at: str, vocabularies: Sequence[tree.File] = ()
) -> rule_lineage.BookLineage:
    """The lineage of rules and provisions in a chain of sound rulebooks, most general first.

    The day ``at`` (ISO) decides which value of a parameter applies. ``vocabularies`` have
    parameters and definitions, too.
    """
    rules: dict[str, list[rule_lineage.LineageStep]] = {}
    provisions: dict[str, list[tuple[_Given, str]]] = {}
    for file in (*vocabularies, *chain):
        book = book_header(file).name
        for item in file.items:
            match item:
                case tree.OptionItem() | tree.ParamItem() | tree.SetItem() | tree.DefineItem():
                    provisions.setdefault(item.name.text, []).append((item, book))
                case tree.RuleItem() | tree.SoftenItem() | tree.DropItem() | tree.SilentItem():
                    steps = rules.setdefault(item.name.text, [])
                    steps.append(_step(item, book, steps))
                case _:
                    pass
    used: set[str] = set()
    unread: list[tree.Item] = [rule for steps in rules.values() if (rule := steps[-1].rule)]
    while unread:
        names = set(names_used(unread.pop())) & provisions.keys()
        unread += [item for name in names - used for item, _ in provisions[name]]
        used |= names
    return rule_lineage.BookLineage(
        tuple(map(book_header, chain)),
        tuple(rule_lineage.RuleHistory(name, tuple(steps)) for name, steps in rules.items()),
        tuple(
            replace(_history(name, given, at), used=name in used)
            for name, given in provisions.items()
        ),
    )


def read_with_lineage(
    reference: str | Path, search_path: Sequence[str | Path] = (), at: str = ""
) -> tuple[Loaded, rule_lineage.BookLineage, Trees]:
    """A rulebook, its lineage and its trees. Arguments and errors as for ``load_rulebook``."""
    trees = read_trees(reference, search_path)
    loaded = resolve_trees(trees, at)
    lineage = book_lineage_of(trees.books, loaded.rulebook.at, trees.vocabularies)
    return loaded, lineage, trees


def book_header(file: tree.File) -> rule_lineage.BookHeader:
    """The header of a rulebook: name, title, law, file and base."""
    return rule_lineage.BookHeader(
        file.name.text if file.name else "",
        title=file.title.text.value if file.title else "",
        law=file.law.text.value if file.law else "",
        as_of=file.law.as_of if file.law else "",
        file=PurePath(file.span.source.name).name,
        extends=file.extends.name.text if file.extends else "",
    )


def _step(
    item: tree.RuleItem | tree.SoftenItem | tree.DropItem | tree.SilentItem,
    book: str,
    earlier: Sequence[rule_lineage.LineageStep],
) -> rule_lineage.LineageStep:
    match item:
        case tree.DropItem(because=because):
            return rule_lineage.LineageStep(book, "dropped", None, (), because.value)
        case tree.SilentItem(because=because):
            return rule_lineage.LineageStep(book, "silent", None, (), because.value)
        case tree.RuleItem(override=False):
            return rule_lineage.LineageStep(book, "declared", item, gives_law=True)
    before = earlier[-1].rule
    assert before is not None, "nobody changes a rule that is gone"
    if isinstance(item, tree.RuleItem):
        after = merged(before, item)
        deed: rule_lineage.LineageAction = "confirmed" if item.confirm else "overridden"
        changed = _changed_clauses(before, after)
        gives_law = item.cite is not None
        parts = [unless.span.text.removeprefix("also") for unless in lost_exceptions(before, item)]
        lost = tuple([" ".join(part.split()) for part in parts])
        return rule_lineage.LineageStep(book, deed, after, changed, gives_law=gives_law, lost=lost)
    after = softened(before, item)
    why = item.because.value if item.because else ""
    return rule_lineage.LineageStep(book, "softened", after, _changed_clauses(before, after), why)


HARDNESS = "hard or soft"
"""The name, in lists of clauses, of the word before ``rule``."""


def _changed_clauses(before: tree.RuleItem, after: tree.RuleItem) -> tuple[str, ...]:
    return tuple(
        HARDNESS if field == "strength" else field.replace("_", " ")
        for field in CLAUSES
        if getattr(before, field) != getattr(after, field)
    )


def _history(
    name: str, given: Sequence[tuple[_Given, str]], at: str
) -> rule_lineage.ConstantHistory:
    """All statements of a chain about a provision; the chain begins with the most general book."""
    dates: list[tree.InForce | None] = [getattr(item, "in_force", None) for item, _ in given]
    good = [index for index, own in enumerate(dates) if in_force(own, at)]
    head = _head(given[-1][0])
    settings = tuple(
        rule_lineage.ConstantValue(
            book,
            _text(item),
            since=own.since if own else "",
            until=own.until if own else "",
            current=good[-1:] == [index],
            cite=item.cite.value if item.cite else "",
            note=description(item.span),
            head="" if _head(item) == head else _head(item),
        )
        for index, ((item, book), own) in enumerate(zip(given, dates, strict=True))
    )
    kind: rule_lineage.ConstantKind = "parameter"
    if isinstance(given[0][0], tree.OptionItem):
        kind = "option"
    elif isinstance(given[0][0], tree.DefineItem):
        kind = "definition"
    return rule_lineage.ConstantHistory(kind, name, head, settings)


def _head(item: _Given) -> str:
    own = print_parameters(item.parameters) if isinstance(item, tree.DefineItem) else ""
    return item.name.text + own


def _text(item: _Given) -> str:
    body = item.body if isinstance(item, tree.DefineItem) else item.value
    if isinstance(body, bool):
        return "on" if body else "off"
    return print_formula(body, "written")
