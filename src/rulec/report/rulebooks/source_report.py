"""What rules rest on, given a source that provides only some words, as text and Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rulec.analysis.audit.source_audit import Basis, RuleBasis, SourceAudit
from rulec.report.text import terminal_text
from rulec.report.text.markdown import code, table
from rulec.report.text.terminal_text import broken, fact_lines, styled, visible

_TITLES: Mapping[Basis, str] = {
    "evidence": "judged on evidence",
    "presumption": "judged, with presumptions",
    "nothing": "cannot be judged",
}


def counted(audit: SourceAudit) -> str:
    """The numbers of rules in one sentence."""
    n = {basis: audit.count(basis) for basis in _TITLES}
    return (
        f"{terminal_text.counted(len(audit.rules), 'rule')}: {n['evidence']:,} judged on evidence, "
        f"{n['presumption']:,} with presumptions, {n['nothing']:,} cannot be judged"
    )


def as_text(audit: SourceAudit, width: int) -> str:
    """The totals, then the rules by what they rest on, with the names that matter."""
    first, *rest = broken(visible(f"source {audit.source}: {counted(audit)}"), width, later="  ")
    blocks = ["\n".join([first.replace("source", styled("source", "bold"), 1), *rest])]
    for basis, title in _TITLES.items():
        facts = [(rule.rule, _note(rule)) for rule in audit.rules if rule.basis == basis]
        if facts:
            blocks.append("\n".join([styled(title, "bold"), *fact_lines(facts, width)]))
    return "\n\n".join(blocks)


def as_markdown(audit: SourceAudit) -> str:
    """A table of the rules."""
    rows = [
        [code(rule.rule), _TITLES[rule.basis], _note(rule).replace("_", "\\_")]
        for rule in audit.rules
    ]
    head = f"## From {code(audit.source)}\n\n{counted(audit).capitalize()}."
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
