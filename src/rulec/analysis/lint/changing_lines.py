"""The lines by which a rulebook changes rules that it inherits and does not write anew."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rulec.diagnostics import Span
from rulec.rulebook.names.referenced_names import names_used
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
    used = _names_used(books)
    changes: dict[str, Change] = {}
    for name in dict.fromkeys(
        item.name.text for book in books for item in book.items if isinstance(item, tree.RuleItem)
    ):
        soften = softened.get(name)
        behind = [lines[word] for word in lines if word in _behind(name, used)]
        spans = [*behind, *([soften.span] if soften else [])]
        if spans:
            why = soften is not None and soften.because is not None
            changes[name] = Change(tuple(sorted(spans, key=lambda span: span.start)), why)
    return changes


def _names_used(books: Sequence[tree.File]) -> Mapping[str, frozenset[str]]:
    """The names that rules, definitions and parameters of these names use, in any of the books."""
    used: dict[str, frozenset[str]] = {}
    for book in books:
        for item in book.items:
            if isinstance(item, tree.RuleItem | tree.DefineItem | tree.ParamItem | tree.SetItem):
                name = item.name.text
                used[name] = used.get(name, frozenset()) | frozenset(names_used(item))
    return used


def _behind(name: str, used: Mapping[str, frozenset[str]]) -> set[str]:
    """All names that a rule uses, also by way of others."""
    found, waiting = set[str](), [name]
    while waiting:
        for word in used.get(waiting.pop(), ()):
            if word not in found:
                found.add(word)
                waiting.append(word)
    return found
