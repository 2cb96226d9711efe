"""Adds a note with the cited provision to diagnostics within a rule."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import replace

from rulec.diagnostics import Diagnostic
from rulec.rulebook.rulebook_model import provision_note
from rulec.syntax import tree
from rulec.syntax.messages.structure import UNBALANCED_BRACE


def with_provisions(
    findings: Iterable[Diagnostic],
    books: Sequence[tree.File],
) -> tuple[Diagnostic, ...]:
    """Findings; those within a rule get a note with what it cites.

    ``books`` are those that a rulebook extends, the most general first, and itself; an override
    that cites nothing has the provision of the overridden rule.
    """
    diagnostics = tuple(findings)
    if not diagnostics:
        return diagnostics
    cited: dict[str, str] = {}
    rules: dict[str, list[tuple[int, int, str]]] = {}
    for book in books:
        for item in book.items:
            if not isinstance(item, tree.RuleItem):
                continue
            if item.cite is not None:
                cited[item.name.text] = item.cite.value
            if provision := cited.get(item.name.text):
                place = item.span.place
                lines = (place.line or 0, place.end_line or 0)
                note = provision_note(item.name.text, provision)
                rules.setdefault(place.file, []).append((*lines, note))
    return tuple(_noted(finding, rules) for finding in diagnostics)


def _noted(finding: Diagnostic, rules: dict[str, list[tuple[int, int, str]]]) -> Diagnostic:
    place = finding.place
    if finding.code == UNBALANCED_BRACE.code and finding.labels:
        # It stands in the next rule, where something should have ended; its label is in this one.
        place = finding.labels[0].place
    if place is None or place.line is None:
        return finding
    within = rules.get(place.file, [])
    index = bisect_right(within, place.line, key=lambda entry: entry[0]) - 1
    if index < 0 or place.line > within[index][1]:
        return finding
    return replace(finding, notes=(*finding.notes, within[index][2]))
