"""Summary of a fleet run as text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.files.left_alone import in_words
from rulec.fleet.runs.fleet_folder import FleetTally
from rulec.fleet.runs.fleet_run import FleetRun
from rulec.monitoring.verdict import VerdictOutcome
from rulec.report.text.terminal_text import visible
from rulec.report.verdicts import verdict_report
from rulec.report.verdicts.batch_table import BatchTally, as_columns

_MOST_REASONS = 5


def as_text(run: FleetRun) -> str:
    """Drives, hours, kilometres; each rule with outcomes other than kept; the findings' folder."""
    return visible_lines([*_drives(run), *_rules(run), *_files(run)])


def compared(runs: Sequence[tuple[CompiledRulebook, FleetRun]]) -> str:
    """A table of how many drives violate each rule, with a column for each rulebook."""
    return as_columns([(rules, _verdicts(run.tally)) for rules, run in runs])


def _verdicts(tally: FleetTally) -> BatchTally:
    """The tally as a tally of verdicts, without recordings."""
    verdicts = BatchTally(Counter(_outcomes(tally)), not_judged=tally.drives["not judged"])
    for (rule, outcome), number in tally.rules.items():
        if outcome != "not_judged":
            verdicts.judged_in[rule] += number
        if outcome == "violated":
            verdicts.drives[rule] += number
        elif outcome == "open":
            verdicts.open_in[rule] += number
    return verdicts


def _outcomes(tally: FleetTally) -> dict[VerdictOutcome, int]:
    return {
        outcome: tally.drives[outcome]
        for outcome in verdict_report.OUTCOMES
        if tally.drives[outcome]
    }


def visible_lines(lines: list[str]) -> str:
    """Lines as one text, without characters that control a terminal."""
    return "\n".join(visible(line) for line in lines)


def _drives(run: FleetRun) -> Iterator[str]:
    tally, by = run.tally, run.by
    chosen = "".join(f", {text}" for text in (by.thresholds, by.assumptions) if text)
    yield f"rulebook    {by.rulebook} ({by.rulebook_hash[:12]}), rulec {by.rulec}{chosen}"
    _, _, outcomes = verdict_report.summary(_outcomes(tally), 0, "drive").partition(": ")
    yield f"drives      {tally.judged:,} judged: {outcomes}"
    distance = f", {tally.km:,.1f} km" if tally.km else ""
    driven = f"{tally.hours:,.2f} h" if tally.hours >= 1 else f"{tally.hours * 3600:,.1f} s"
    yield f"driven      {driven}{distance}"
    for remark, count in tally.remarks.most_common(_MOST_REASONS):
        drives = "1 drive" if count == 1 else f"{count:,} drives"
        yield f"note        {drives}: {remark} (as in {tally.examples[remark]})"
    if len(tally.remarks) > _MOST_REASONS:
        others = len(tally.remarks) - _MOST_REASONS
        yield f"note        and {others:,} more; the column `remarks` has them all"
    if not tally.drives["not judged"]:
        return
    reasons = tally.reasons.most_common(_MOST_REASONS)
    yield f"not judged  {tally.drives['not judged']:,}:"
    for why, count in reasons:
        where = tally.examples[why]
        where = where if count == 1 else f"as in {where}"
        yield f"  {count:,}: {why} ({where})"
    others = len(tally.reasons) - len(reasons)
    if others:
        yield f"  and for {others:,} more reasons"


def _rules(run: FleetRun) -> Iterator[str]:
    rules = run.tally.rules
    for name in dict.fromkeys(name for name, _ in sorted(rules)):
        counts = {x: rules[name, x] for x in ("violated", "open", "not_judged") if rules[name, x]}
        if counts:
            outcomes = ", ".join(f"{x.replace('_', ' ')} {n:,}" for x, n in counts.items())
            yield f"  {name}: {outcomes}"


def _files(run: FleetRun) -> Iterator[str]:
    for fault, _ in run.tally.faults.most_common(_MOST_REASONS):
        yield f"fault       {fault}"
    if len(run.tally.faults) > _MOST_REASONS:
        yield f"fault       and {len(run.tally.faults) - _MOST_REASONS:,} more"
    for lost in run.tally.lost:
        yield f"lost        {lost}: its process was stopped twice, perhaps for lack of memory"
    if run.left_alone:
        yield f"left alone  {in_words(run.left_alone)}"
    for path in run.leftovers:
        yield f"left over   {path}: it belongs to no input of this run"
    written = run.units - run.before - len(run.tally.lost)
    before = f"; {run.before:,} more were there before" if run.before else ""
    files = "file" if written == 1 else "files"
    yield f"wrote {written:,} {files} of findings to {run.findings}{before}"
