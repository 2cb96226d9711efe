"""Verdicts on recorded vehicles, as a table of rules and vehicles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import shorten

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.extraction.drives import NoDrive
from rulec.extraction.recording_verdicts import RecordingVerdicts, ViolationTally
from rulec.report.text.terminal_text import first_of, table_lines, visible
from rulec.report.verdicts import verdict_report

MOST_DEFAULTS = 4
"""So many words that are taken by default are named for a rule; JSON has them all."""

MOST_VEHICLES = 6
LONGEST_RULE = 48


def as_text(judged: RecordingVerdicts, tally: ViolationTally) -> str:
    """The recording in a few lines, and the table of violations."""
    recording = judged.recording
    lines = [
        f"recording   {recording.name}: {_drives(tally.judged)} in steps of {recording.step_s:g} s",
        *_not_judged(tally.not_judged),
    ]
    if judged.mirrored:
        before = "right" if recording.side == "left" else "left"
        lines.append(
            f"mirrored    recorded where traffic keeps to the {before}, "
            f"judged as if it kept to the {recording.side}"
        )
    defaults = defaulted_names(judged, tally.words or frozenset())
    if defaults:
        lines.append(f"by default  {first_of(defaults, MOST_DEFAULTS)}: the recording does not say")
    lines += [f"note        {remark}" for remark in recording.remarks]
    lines += _table(judged, tally)
    return "\n".join(visible(line) for line in lines)


def _drives(count: int) -> str:
    return f"{count:,} {'drive' if count == 1 else 'drives'}"


def _not_judged(no_drives: Sequence[NoDrive]) -> Iterator[str]:
    reasons: dict[str, list[str]] = {}
    for no_drive in no_drives:
        reasons.setdefault(no_drive.why, []).append(no_drive.ego)
    for why, egos in reasons.items():
        yield f"not judged  {first_of(egos, MOST_VEHICLES)}: {why}"


def defaulted_names(judged: RecordingVerdicts, words: frozenset[str]) -> list[str]:
    """Inputs of rules that a recording's words lack."""
    missing = {name for names in judged.by_default(words).values() for name in names}
    return [name for name in judged.rules.vocabulary.declarations if name in missing]


def _table(judged: RecordingVerdicts, tally: ViolationTally) -> Iterator[str]:
    if not tally.first_s:
        return
    defaults = judged.by_default(tally.words or frozenset())
    rules = [rule for rule in judged.rules.rules if rule.name in tally.first_s]
    titles = [shorten(_title(rule), LONGEST_RULE, placeholder=" …]") for rule in rules]
    rows = [("violated", "", " drives", "   first", "by")]
    for rule, title in zip(rules, titles, strict=True):
        times = tally.first_s[rule.name]
        who = sorted(times, key=lambda ego: times[ego])
        share, first = f"{len(times)}/{tally.judged}", f"{min(times.values()):g} s"
        rows.append((title, rule.strength, share, first, first_of(who, MOST_VEHICLES)))
    heads, *lines = table_lines(rows, right=(2, 3))
    yield from ("", heads)
    for rule, line in zip(rules, lines, strict=True):
        yield line
        if defaults[rule.name]:
            yield f"  by default: {first_of(defaults[rule.name], MOST_DEFAULTS)}"


def _title(rule: CompiledRule) -> str:
    return f"{rule.name} [{rule.cite}]" if rule.cite else rule.name


def summary(tally: ViolationTally) -> str:
    """The line that ends a run."""
    line = verdict_report.summary(len(tally.satisfied), len(tally.violated), len(tally.not_judged))
    return line.replace("traces", "drives").replace("trace", "drive")
