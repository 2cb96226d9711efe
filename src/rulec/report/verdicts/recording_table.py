"""Verdicts on recorded vehicles: a table of rules and vehicles."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from textwrap import shorten, wrap

from rulec.automata.bundle.compiled_rulebook import CompiledRule, TooLargeRule
from rulec.diagnostics import first_of
from rulec.extraction.recording_verdicts import RecordingVerdicts, ViolationTally
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.report.text.terminal_text import counted, mirrored_line, table_lines, visible
from rulec.report.verdicts import verdict_report

MOST_DEFAULTS = 4
"""Number of a rule's default words that are named; JSON has all of them."""

MOST_VEHICLES = 6
MOST_CAUSES = 3
LONGEST_RULE = 48

MOST_UNJUDGED = 100
"""Number of rules that are named as not judged; JSON has all of them."""

LABEL = 12
"""Width of a line's label in characters."""


def as_text(verdicts: RecordingVerdicts, tally: ViolationTally, width: int) -> str:
    """The recording in a few lines, and the table of violations."""
    recording = verdicts.recording
    drives = counted(tally.judged, "drive")
    lines = [
        f"recording   {recording.name}: {drives} in steps of {recording.step_s:g} s",
        *_not_judged(tally.not_judged),
    ]
    if verdicts.mirrored:
        lines.append(mirrored_line(str(recording.side)))
    elif recording.side is None and verdicts.rules.traffic == "left":
        lines.append("side        the side of traffic is unknown: assumed to be the left")
    defaults = defaulted_names(verdicts, tally.words or frozenset())
    if defaults:
        lines.append(f"by default  {first_of(defaults, MOST_DEFAULTS)}: the recording does not say")
    if verdicts.defaults:
        lines.append("assumed     defaults, and that nothing comes after the recording's end")
    lines += _rule_counts(verdicts, tally, width)
    for fault in [*tally.faults][:MOST_CAUSES]:
        lines += _folded("fault", fault, width)
    if len(tally.faults) > MOST_CAUSES:
        lines += _folded("", f"and {len(tally.faults) - MOST_CAUSES:,} more", width)
    lines += [f"note        {remark}" for remark in recording.remarks]
    lines += _table(verdicts, tally)
    return "\n".join(visible(line) for line in lines)


def _rule_counts(verdicts: RecordingVerdicts, tally: ViolationTally, width: int) -> Iterator[str]:
    """The number of rules judged, open and not judged, and the words that are missing."""
    if not tally.judged:
        return
    rules: list[CompiledRule | TooLargeRule] = [
        *verdicts.rules.rules,
        *verdicts.rules.too_large,
    ]
    vocabulary = verdicts.rules.vocabulary
    # It may also depend on the types that participants of unknown type have
    order = [*vocabulary.declarations, *vocabulary.types]
    words = first_of(sorted(tally.open_on, key=order.index), MOST_DEFAULTS)
    judged = {rule.name for rule in rules if tally.judged_in[rule.name]} | {*tally.first_s}
    counts = verdict_report.rule_counts(rules, judged, tally.open_rules, "this recording", words)
    yield f"rules       {counts}"
    with_any = judged | {*tally.open_rules}
    yield from _unjudged([rule for rule in rules if rule.name not in with_any], tally, width)


def _unjudged(
    rules: Sequence[CompiledRule | TooLargeRule], tally: ViolationTally, width: int
) -> Iterator[str]:
    """The rules that cannot be judged, hard ones first, grouped by the words that are missing."""
    by_words: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for rule in sorted(rules, key=lambda compiled_rule: compiled_rule.strength != "hard")[
        :MOST_UNJUDGED
    ]:
        reasons = [tally.reasons[rule.name]] if rule.name in tally.reasons else []
        words = tuple(tally.untold.get(rule.name) or reasons)
        by_words.setdefault((rule.strength, words), []).append(rule.name)
    for strength in ("hard", "soft"):
        lacking = [
            f"{', '.join(names)} ({', '.join(words)})" if words else ", ".join(names)
            for (of, words), names in by_words.items()
            if of == strength
        ]
        if lacking:
            yield from _folded("no verdict", f"{strength}: {'; '.join(lacking)}", width)
    if len(rules) > MOST_UNJUDGED:
        yield from _folded("", f"and {len(rules) - MOST_UNJUDGED:,} more", width)
    if by_words:
        way_out = "`rulec explain WORD` says which recordings can provide a word in brackets"
        yield from _folded("", way_out, width)


def _folded(label: str, text: str, width: int) -> list[str]:
    """A text with a label before it, wrapped to a width."""
    first, later = label.ljust(LABEL), " " * LABEL
    return wrap(text, width, initial_indent=first, subsequent_indent=later, break_on_hyphens=False)


def _not_judged(no_drives: Sequence[NoDrive]) -> Iterator[str]:
    reasons: dict[str, list[str]] = {}
    for no_drive in no_drives:
        reasons.setdefault(no_drive.why, []).append(no_drive.ego)
    for why, egos in reasons.items():
        yield f"not judged  {first_of(egos, MOST_VEHICLES)}: {why}"


def defaulted_names(verdicts: RecordingVerdicts, words: frozenset[str]) -> list[str]:
    """The words that rules read and the recording does not provide."""
    missing = {name for names in verdicts.by_default(words).values() for name in names}
    return [name for name in verdicts.rules.vocabulary.declarations if name in missing]


def _table(verdicts: RecordingVerdicts, tally: ViolationTally) -> Iterator[str]:
    if not tally.first_s:
        return
    defaults = verdicts.by_default(tally.words or frozenset())
    # In the order found, so that the first one is the first that is explained
    by_name = {rule.name: rule for rule in verdicts.rules.rules}
    rules = [by_name[name] for name in tally.first_s]
    names = [verdict_report.short_title(rule) for rule in rules]
    titles = [shorten(name, LONGEST_RULE, placeholder=" …]") for name in names]
    rows = [("violated", "", " drives", "   first", "by")]
    for rule, title in zip(rules, titles, strict=True):
        times = tally.first_s[rule.name]
        egos = sorted(times, key=lambda ego: times[ego])
        share, first = f"{len(times)}/{tally.judged}", f"{min(times.values()):g} s"
        rows.append((title, rule.strength, share, first, first_of(egos, MOST_VEHICLES)))
    heads, *lines = table_lines(rows, right=(2, 3))
    yield from ("", heads)
    for rule, line in zip(rules, lines, strict=True):
        yield line
        yield from _findings(tally.causes[rule.name])
        if defaults[rule.name]:
            yield f"  by default: {first_of(defaults[rule.name], MOST_DEFAULTS)}"


def _findings(causes: Mapping[tuple[str, ...], Sequence[str]]) -> Iterator[str]:
    """Causes shared by several drives, those of most drives first."""
    shared = [(about, drives) for about, drives in causes.items() if about and len(drives) > 1]
    shared.sort(key=lambda cause: -len(cause[1]))
    for about, drives in shared[:MOST_CAUSES]:
        yield f"  one finding in {len(drives):,} drives, about {', '.join(about)}"
    if len(shared) > MOST_CAUSES:
        yield f"  and {len(shared) - MOST_CAUSES:,} more findings of several drives"


def summary(tally: ViolationTally) -> str:
    """The summary line of a run."""
    counts = {True: len(tally.satisfied), False: len(tally.violated), None: len(tally.doubtful)}
    return verdict_report.summary(counts, len(tally.not_judged), "drive")
