"""Audits of rulebooks as text, as Markdown, and as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import groupby
from textwrap import fill, wrap

import click

from rulec.analysis.audit.audit_kinds import KINDS
from rulec.analysis.audit.rulebook_audit import Audit, AuditChanges, AuditFinding
from rulec.report.findings.source_excerpt import visible
from rulec.report.json_document import JsonDocument, as_indented
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.markdown import code, escaped, table

Compared = Mapping[str, AuditChanges]
"""Rulebook -> what has changed since an older audit of it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedAudit(Audit):
    """An audit, and what has changed since an older one if there was any."""

    changes: AuditChanges | None


class AuditDocument(JsonDocument, frozen=True, kw_only=True):
    """The audits of rulebooks."""

    audits: Sequence[ComparedAudit]


def render(
    audits: Sequence[Audit], compared: Compared, output_format: str, width: int = PAGE_WIDTH
) -> str:
    """All audits as ``text`` of a width, ``markdown`` or ``json``."""
    match output_format:
        case "json":
            return _as_json(audits, compared)
        case "markdown":
            return "\n\n".join(_as_markdown(one, compared.get(one.rulebook)) for one in audits)
        case _:
            return "\n\n\n".join(_as_text(one, compared.get(one.rulebook), width) for one in audits)


def counts(audit: Audit) -> Iterator[tuple[str, str]]:
    """What there is, in words and in numbers."""
    found = audit.counts
    of_all = f"of {found.rules:,}"
    yield "rules", f"{found.rules:,} ({found.hard:,} hard, {found.soft:,} soft)"
    yield "with a provision cited", f"{found.cited:,} {of_all}"
    yield "with examples for both verdicts", f"{found.tested:,} {of_all}"
    yield "verified in the law itself", f"{found.verified:,} {of_all}"
    yield "examples", f"{found.examples:,}"
    yield "provisions of the law", f"{found.articles:,}"
    yield "words of the vocabulary in use", f"{found.words_used:,} of {found.words:,}"


def law_of(audit: Audit) -> str:
    """Which law it is, and of which day."""
    since = f", as of {audit.as_of}" if audit.as_of else ""
    return f"{audit.law}{since}" if audit.law else "no law is named"


def _as_text(audit: Audit, compared: AuditChanges | None, width: int) -> str:
    title = f": {audit.title}" if audit.title else ""
    rows = [("law", law_of(audit)), ("judged by the law of", audit.at), *counts(audit)]
    blocks = [
        click.style(visible(f"{audit.rulebook}{title}"), bold=True) + "\n" + _rows(rows, width)
    ]
    for kind, found in groupby(audit.findings, key=lambda one: one.kind):
        blocks.append(
            f"{click.style(kind, bold=True)}: {KINDS[kind]}\n{_lines(list(found), width)}"
        )
    for book, articles in groupby(audit.articles, key=lambda one: one.book):
        title = f"{click.style('provisions', bold=True)} cited in {book}, and the rules they are in"
        rows = [(one.cite, ", ".join(one.rules)) for one in articles]
        blocks.append(f"{title}\n{_rows(rows, width)}")
    if compared is not None:
        blocks.append(_changes_as_text(compared))
    return "\n\n".join(blocks)


def _lines(found: Sequence[AuditFinding], width: int) -> str:
    if not any(one.note for one in found):
        names = ", ".join(visible(one.name) for one in found)
        return fill(names, width, initial_indent="  ", subsequent_indent="  ")
    return _rows([(one.name, one.note) for one in found], width)


def _rows(rows: Sequence[tuple[str, str]], width: int) -> str:
    """Two columns; what is too long for the second one goes on below it."""
    column = max(len(visible(name)) for name, _ in rows)
    lines: list[str] = []
    for name, text in rows:
        first, *rest = wrap(visible(text), max(20, width - column - 4)) or [""]
        lines.append(f"  {visible(name):<{column}}  {first}".rstrip())
        lines += [f"{'':{column + 4}}{line}" for line in rest]
    return "\n".join(lines)


def _changes_as_text(compared: AuditChanges) -> str:
    lines = [
        f"{sign} {one.kind}: {visible(one.name)}"
        for sign, found in (("+", compared.appeared), ("-", compared.vanished))
        for one in found
    ]
    title = click.style("changed", bold=True)
    return f"{title}: + is new, - is gone\n" + "\n".join(f"  {one}" for one in lines or ["nothing"])


def _as_markdown(audit: Audit, compared: AuditChanges | None) -> str:
    title = f": {escaped(audit.title)}" if audit.title else ""
    blocks = [
        f"# Audit of {code(audit.rulebook)}{title}",
        f"Law: {escaped(law_of(audit))}. Judged by the law of {audit.at}.",
        table(["count", "number"], [[name, value] for name, value in counts(audit)]),
        "## Findings",
        table(
            ["kind", "what it is about", "note"],
            [
                [one.kind, escaped(one.name), escaped(one.note) if one.note else ""]
                for one in audit.findings
            ],
        )
        if audit.findings
        else "None.",
    ]
    if audit.findings:
        kinds = dict.fromkeys(one.kind for one in audit.findings)
        blocks.append("\n".join(f"- *{kind}*: {KINDS[kind]}" for kind in kinds))
    if audit.articles:
        rows = [
            [escaped(one.cite), code(one.book), ", ".join(map(code, one.rules))]
            for one in audit.articles
        ]
        blocks += ["## Provisions of the law", table(["provision", "cited in", "rules"], rows)]
    if compared is not None:
        blocks += ["## Changes", _changes_as_markdown(compared)]
    return "\n\n".join(blocks)


def _changes_as_markdown(compared: AuditChanges) -> str:
    rows = [
        [word, one.kind, escaped(one.name)]
        for word, found in (("new", compared.appeared), ("gone", compared.vanished))
        for one in found
    ]
    return table(["change", "kind", "what it is about"], rows) if rows else "None."


def _as_json(audits: Sequence[Audit], compared: Compared) -> str:
    return as_indented(
        AuditDocument(
            audits=[
                ComparedAudit(
                    **{field.name: getattr(audit, field.name) for field in fields(audit)},
                    changes=compared.get(audit.rulebook),
                )
                for audit in audits
            ]
        )
    )
