"""Audits of rulebooks as text, as Markdown, and as JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import groupby
from typing import get_args

from rulec.analysis.audit.audit_kinds import KINDS
from rulec.analysis.audit.provision_coverage import ListedProvision, ProvisionState
from rulec.analysis.audit.rulebook_audit import Audit, AuditChanges, AuditFinding
from rulec.analysis.audit.source_audit import Basis, RuleBasis, SourceAudit
from rulec.report.json_document import JsonDocument, as_indented
from rulec.report.rulebooks.document_language import IN_ENGLISH, DocumentLanguage
from rulec.report.rulebooks.rule_list import law_of
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.markdown import code, escaped, table
from rulec.report.text.terminal_text import broken, counted, cut, fact_lines, styled, visible

ASKED_FOR = frozenset({"failing", "not-found", "unread", "law-changed"})
"""Kinds of findings that only an option looks for."""

Compared = Mapping[str, AuditChanges]
"""Rulebook -> the changes since an older audit of it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedAudit(Audit):
    """An audit, and its changes since an older one, if any."""

    changes: AuditChanges | None


class AuditDocument(JsonDocument, frozen=True, kw_only=True):
    """The audits of rulebooks, and of what rules rest on with given ``sources``, if requested."""

    audits: Sequence[ComparedAudit]
    sources: Sequence[SourceAudit] = ()


def render(
    audits: Sequence[Audit],
    compared: Compared,
    output_format: str,
    width: int = PAGE_WIDTH,
    sources: Sequence[SourceAudit] = (),
    *,
    in_full: bool,
) -> str:
    """All audits as ``text`` of a width, ``markdown`` or ``json``, then those of sources.

    Text has every finding and article only ``in_full``.
    """
    pairs = [(audit, compared.get(audit.rulebook)) for audit in audits]
    match output_format:
        case "json":
            changed = [_with_changes(*pair) for pair in pairs]
            return as_indented(AuditDocument(audits=changed, sources=sources))
        case "markdown":
            parts = [_as_markdown(*pair) for pair in pairs]
            return "\n\n".join([*parts, *map(_source_as_markdown, sources)])
        case _:
            parts = [_as_text(*pair, width, in_full=in_full) for pair in pairs]
            parts += [_source_as_text(source, width) for source in sources]
            return "\n\n\n".join(parts)


def _with_changes(audit: Audit, changes: AuditChanges | None) -> ComparedAudit:
    known = {field.name: getattr(audit, field.name) for field in fields(audit)}
    return ComparedAudit(**known, changes=changes)


def counts(audit: Audit) -> Iterator[tuple[str, str]]:
    """The audit's counts, each with a label."""
    n = audit.counts
    of_all = f"of {n.rules:,}"
    yield "rules", f"{n.rules:,} ({n.hard:,} hard, {n.soft:,} soft)"
    yield "with a provision cited", f"{n.cited:,} {of_all}"
    yield "with examples for both verdicts", f"{n.tested:,} {of_all}"
    yield "own law, not merely inherited", f"{n.confirmed:,} {of_all}"
    yield "verified in the law itself", f"{n.verified:,} of {n.confirmed:,}"
    yield "examples", f"{n.examples:,}"
    yield "provisions of the law", f"{n.articles - n.inherited_articles:,}"
    if n.inherited_articles:
        yield "provisions of inherited law", f"{n.inherited_articles:,}"
    if audit.provisions:
        yield "articles dealt with", progress(audit.provisions)
        n_read = sum(article.certainty == "verified" for article in audit.provisions)
        yield "listed articles that were read", f"{n_read:,} of {len(audit.provisions):,}"
    if audit.law_text:
        yield f"cites found in {audit.law_text}", f"{n.cites_found:,} of {n.cites_looked_for:,}"
    yield "words of the vocabulary in use", f"{n.words_used:,} of {n.words:,}"


def progress(provisions: Sequence[ListedProvision], words: DocumentLanguage = IN_ENGLISH) -> str:
    """The share of listed articles dealt with: in percent, as a bar, and by state."""
    states = Counter(article.state for article in provisions)
    done = len(provisions) - states["to do"]
    filled = _BAR * done // len(provisions)
    bar = "█" * filled + "░" * (_BAR - filled)
    numbers = ", ".join(f"{states[x]:,} {words.say(x)}" for x in get_args(ProvisionState))
    counted = words.say("{} of {}", f"{done:,}", f"{len(provisions):,}")
    return f"{100 * done // len(provisions)} % {bar} {counted}: {numbers}"


_BAR = 20
"""Width of a progress bar in characters."""


def provision_row(
    article: ListedProvision, words: DocumentLanguage = IN_ENGLISH
) -> tuple[str, str, str]:
    """A listed article's number, heading and state."""
    say = words.say
    rules = say(" by {}", ", ".join(article.rules)) if article.rules else ""
    because = say(", because {}", article.because) if article.because else ""
    recalled = f" {say('(from memory)')}" if article.certainty == "unverified" else ""
    return article.number, f"{article.heading}{recalled}", f"{say(article.state)}{rules}{because}"


def provision_table(
    provisions: Sequence[ListedProvision], words: DocumentLanguage = IN_ENGLISH
) -> str:
    """The listed articles as a Markdown table."""
    rows = [[*map(escaped, provision_row(article, words))] for article in provisions]
    head = [words.say("article"), words.say("heading"), words.say("what has become of it")]
    return table(head, rows)


def _head(audit: Audit, width: int) -> list[str]:
    title = f": {audit.title}" if audit.title else ""
    rows = [("law", law_of(audit)), ("judged by the law of", audit.at), *counts(audit)]
    return [styled(visible(f"{audit.rulebook}{title}"), "bold"), *fact_lines(rows, width)]


def _as_text(audit: Audit, compared: AuditChanges | None, width: int, *, in_full: bool) -> str:
    """The counts, and two lines for each kind of finding; ``in_full`` all notes and articles.

    What an option has asked for is always shown in full.
    """
    lines = _head(audit, width)
    gap = [""] * in_full
    for kind, grouped in groupby(audit.findings, key=lambda finding: finding.kind):
        findings = list(grouped)
        number = "" if in_full else f" ({len(findings):,})"
        lines += [*gap, *_titled(kind, f"{number}: {KINDS[kind]}", width)]
        if in_full or kind in ASKED_FOR:
            lines.append(_lines(findings, width))
        else:
            lines.append(cut("  " + visible(", ".join(x.name for x in findings)), width))
    if in_full:
        lines += _articles(audit, width)
    else:
        lines.append("`--all` has every note, and the articles that rules rest on")
    return "\n".join([*lines, *(gap + _changes_as_text(compared, width) if compared else ())])


def _articles(audit: Audit, width: int) -> Iterator[str]:
    if audit.provisions:
        yield from ("", *_titled("articles", " of the law, and the rules that rest on them", width))
        rows = [
            (number, f"{heading}: {state}")
            for number, heading, state in map(provision_row, audit.provisions)
        ]
        yield from fact_lines(rows, width)
    for book, articles in groupby(audit.articles, key=lambda article: article.book):
        yield from (
            "",
            *_titled("provisions", f" cited in {book}, and the rules they are in", width),
        )
        yield from fact_lines([(x.cite, ", ".join(x.rules)) for x in articles], width)


def _titled(kind: str, rest: str, width: int) -> list[str]:
    first, *others = broken(visible(f"{kind}{rest}"), width, later="  ")
    return [f"{styled(kind, 'bold')}{first[len(kind) :]}", *others]


def _lines(findings: Sequence[AuditFinding], width: int) -> str:
    if not any(finding.note for finding in findings):
        names = visible(", ".join(finding.name for finding in findings))
        return "\n".join(broken(names, width, "  ", "  "))
    facts = [(finding.name, finding.note) for finding in findings]
    return "\n".join(fact_lines(facts, width))


def _changes_as_text(compared: AuditChanges, width: int) -> list[str]:
    changes = [
        line
        for sign, findings in (("+", compared.appeared), ("-", compared.vanished))
        for finding in findings
        for line in broken(visible(f"{sign} {finding.kind}: {finding.name}"), width, "  ", "    ")
    ]
    return [f"{styled('changed', 'bold')}: + is new, - is gone", *(changes or ["  nothing"])]


def _as_markdown(audit: Audit, compared: AuditChanges | None) -> str:
    title = f": {escaped(audit.title)}" if audit.title else ""
    findings = [
        [finding.kind, escaped(finding.name), escaped(finding.note)] for finding in audit.findings
    ]
    blocks = [
        f"# Audit of {code(audit.rulebook)}{title}",
        f"Law: {escaped(law_of(audit))}. Judged by the law of {audit.at}.",
        table(["count", "number"], counts(audit)),
        "## Findings",
        table(["kind", "what it is about", "note"], findings) if findings else "None.",
    ]
    if findings:
        kinds = dict.fromkeys(kind for kind, _, _ in findings)
        blocks.append("\n".join(f"- *{kind}*: {KINDS[kind]}" for kind in kinds))
    if audit.provisions:
        blocks += ["## Articles of the law", provision_table(audit.provisions)]
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
        [word, finding.kind, escaped(finding.name)]
        for word, findings in (("new", compared.appeared), ("gone", compared.vanished))
        for finding in findings
    ]
    return table(["change", "kind", "what it is about"], rows) if rows else "None."


_TITLES: Mapping[Basis, str] = {
    "evidence": "judged on evidence",
    "presumption": "judged, with presumptions",
    "nothing": "cannot be judged",
}


def _source_counts(audit: SourceAudit) -> str:
    """The numbers of rules in one sentence."""
    n = {basis: audit.count(basis) for basis in _TITLES}
    return (
        f"{counted(len(audit.rules), 'rule')}: {n['evidence']:,} judged on evidence, "
        f"{n['presumption']:,} with presumptions, {n['nothing']:,} cannot be judged"
    )


def _source_as_text(audit: SourceAudit, width: int) -> str:
    """The totals, then the rules by what they rest on, with the names that matter."""
    first, *rest = broken(
        visible(f"source {audit.source}: {_source_counts(audit)}"), width, later="  "
    )
    blocks = ["\n".join([first.replace("source", styled("source", "bold"), 1), *rest])]
    for basis, title in _TITLES.items():
        facts = [(rule.rule, _note(rule)) for rule in audit.rules if rule.basis == basis]
        if facts:
            blocks.append("\n".join([styled(title, "bold"), *fact_lines(facts, width)]))
    return "\n\n".join(blocks)


def _source_as_markdown(audit: SourceAudit) -> str:
    """A table of the rules."""
    rows = [
        [code(rule.rule), _TITLES[rule.basis], _note(rule).replace("_", "\\_")]
        for rule in audit.rules
    ]
    head = f"## From {code(audit.source)}\n\n{_source_counts(audit).capitalize()}."
    return f"{head}\n\n{table(['rule', 'verdicts', 'why'], rows)}"


def _note(rule: RuleBasis) -> str:
    return "; ".join(_notes(rule))


def _notes(rule: RuleBasis) -> Iterator[str]:
    if rule.lacking:
        yield f"for want of {', '.join(rule.lacking)}"
        return
    if rule.presumed:
        yield f"presumes {', '.join(rule.presumed)}"
    if rule.untold:
        yield f"open where it depends on {', '.join(rule.untold)}"
