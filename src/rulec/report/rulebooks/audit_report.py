"""Audits of rulebooks as text, as Markdown, and as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import groupby
from textwrap import fill

from rulec.analysis.audit.audit_kinds import KINDS
from rulec.analysis.audit.rulebook_audit import Audit, AuditChanges, AuditFinding
from rulec.report.json_document import JsonDocument, as_indented
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.markdown import code, escaped, table
from rulec.report.text.terminal_text import fact_lines, styled, visible

Compared = Mapping[str, AuditChanges]
"""Rulebook -> what has changed since an older audit of it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedAudit(Audit):
    """An audit, and its changes since an older one, if any."""

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
            return "\n\n".join(
                _as_markdown(audit, compared.get(audit.rulebook)) for audit in audits
            )
        case _:
            return "\n\n\n".join(
                _as_text(audit, compared.get(audit.rulebook), width) for audit in audits
            )


def counts(audit: Audit) -> Iterator[tuple[str, str]]:
    """Counts of the audit, each with its name in words."""
    audit_counts = audit.counts
    of_all = f"of {audit_counts.rules:,}"
    yield (
        "rules",
        f"{audit_counts.rules:,} ({audit_counts.hard:,} hard, {audit_counts.soft:,} soft)",
    )
    yield "with a provision cited", f"{audit_counts.cited:,} {of_all}"
    yield "with examples for both verdicts", f"{audit_counts.tested:,} {of_all}"
    yield "verified in the law itself", f"{audit_counts.verified:,} {of_all}"
    yield "examples", f"{audit_counts.examples:,}"
    yield "provisions of the law", f"{audit_counts.articles:,}"
    yield "words of the vocabulary in use", f"{audit_counts.words_used:,} of {audit_counts.words:,}"


def law_of(audit: Audit) -> str:
    """The rulebook's law and its day."""
    since = f", as of {audit.as_of}" if audit.as_of else ""
    return f"{audit.law}{since}" if audit.law else "no law is named"


def _as_text(audit: Audit, compared: AuditChanges | None, width: int) -> str:
    title = f": {audit.title}" if audit.title else ""
    rows = [("law", law_of(audit)), ("judged by the law of", audit.at), *counts(audit)]
    head = styled(visible(f"{audit.rulebook}{title}"), "bold")
    blocks = ["\n".join([head, *fact_lines(rows, width)])]
    for kind, audit_findings in groupby(audit.findings, key=lambda finding: finding.kind):
        blocks.append(
            f"{styled(kind, 'bold')}: {KINDS[kind]}\n{_lines(list(audit_findings), width)}"
        )
    for book, articles in groupby(audit.articles, key=lambda article: article.book):
        title = f"{styled('provisions', 'bold')} cited in {book}, and the rules they are in"
        rows = [(article.cite, ", ".join(article.rules)) for article in articles]
        blocks.append("\n".join([title, *fact_lines(rows, width)]))
    if compared is not None:
        blocks.append(_changes_as_text(compared))
    return "\n\n".join(blocks)


def _lines(audit_findings: Sequence[AuditFinding], width: int) -> str:
    if not any(audit_finding.note for audit_finding in audit_findings):
        names = ", ".join(visible(audit_finding.name) for audit_finding in audit_findings)
        return fill(names, width, initial_indent="  ", subsequent_indent="  ")
    facts = [(audit_finding.name, audit_finding.note) for audit_finding in audit_findings]
    return "\n".join(fact_lines(facts, width))


def _changes_as_text(compared: AuditChanges) -> str:
    lines = [
        f"{sign} {audit_finding.kind}: {visible(audit_finding.name)}"
        for sign, audit_findings in (("+", compared.appeared), ("-", compared.vanished))
        for audit_finding in audit_findings
    ]
    title = styled("changed", "bold")
    return f"{title}: + is new, - is gone\n" + "\n".join(
        f"  {line}" for line in lines or ["nothing"]
    )


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
                [finding.kind, escaped(finding.name), escaped(finding.note) if finding.note else ""]
                for finding in audit.findings
            ],
        )
        if audit.findings
        else "None.",
    ]
    if audit.findings:
        kinds = dict.fromkeys(finding.kind for finding in audit.findings)
        blocks.append("\n".join(f"- *{kind}*: {KINDS[kind]}" for kind in kinds))
    if audit.articles:
        rows = [
            [escaped(article.cite), code(article.book), ", ".join(map(code, article.rules))]
            for article in audit.articles
        ]
        blocks += ["## Provisions of the law", table(["provision", "cited in", "rules"], rows)]
    if compared is not None:
        blocks += ["## Changes", _changes_as_markdown(compared)]
    return "\n\n".join(blocks)


def _changes_as_markdown(compared: AuditChanges) -> str:
    rows = [
        [word, audit_finding.kind, escaped(audit_finding.name)]
        for word, audit_findings in (("new", compared.appeared), ("gone", compared.vanished))
        for audit_finding in audit_findings
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
