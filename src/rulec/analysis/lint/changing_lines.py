"""The lines by which a rulebook changes rules that it inherits and does not write anew."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

from rulec.diagnostics import Span
from rulec.rulebook.names.referenced_names import free_names
from rulec.rulebook.overlay.rule_override import merged
from rulec.syntax import tree


@dataclass(frozen=True, slots=True)
class Change:
    """What a rulebook does to an inherited rule.

    ``lines`` are those that change it, in their order. ``softened_why``: it is softened, with a
    reason.
    """

    lines: tuple[Span, ...]
    softened_why: bool = False


def changing_lines(books: Sequence[tree.File]) -> Mapping[str, Change]:
    """The changes that the last of some rulebooks makes, by rule; each extends the one before."""
    own = books[-1].items
    lines = {
        item.name.text: item.span
        for item in own
        if isinstance(item, tree.SetItem) or (isinstance(item, tree.DefineItem) and item.again)
    }
    softened = {item.name.text: item for item in own if isinstance(item, tree.SoftenItem)}
    provisions = _names_in_provisions(books)
    changes: dict[str, Change] = {}
    for name, rule in _last_versions(books).items():
        soften = softened.get(name)
        behind = _behind(free_names(rule), provisions)
        spans = [line for word, line in lines.items() if word in behind]
        spans += [soften.span] if soften else []
        if spans:
            why = soften is not None and soften.because is not None
            changes[name] = Change(tuple(sorted(spans, key=lambda span: span.start)), why)
    return changes


def _last_versions(books: Sequence[tree.File]) -> Mapping[str, tree.RuleItem]:
    """The rules with all overrides applied, by name; dropped ones are included."""
    rules: dict[str, tree.RuleItem] = {}
    for item in (item for book in books for item in book.items):
        if isinstance(item, tree.RuleItem):
            before = rules.get(item.name.text)
            rules[item.name.text] = merged(before, item) if before and item.override else item
    return rules


def _names_in_provisions(books: Sequence[tree.File]) -> Mapping[str, frozenset[str]]:
    """The names that a definition uses as it is in the end, and a parameter with any value."""
    used: dict[str, frozenset[str]] = {}
    for item in (item for book in books for item in book.items):
        if isinstance(item, tree.DefineItem):
            used[item.name.text] = free_names(item)
        elif isinstance(item, tree.ParamItem | tree.SetItem):
            used[item.name.text] = used.get(item.name.text, frozenset()) | free_names(item)
    return used


def _behind(names: Set[str], provisions: Mapping[str, frozenset[str]]) -> Set[str]:
    """These names, and all that the definitions and parameters among them use."""
    found, waiting = set(names), [*names]
    while waiting:
        further = provisions.get(waiting.pop(), frozenset()) - found
        found |= further
        waiting += further
    return found
