"""The answer about a recording: who broke which rule, and what was not judged."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from shlex import quote
from typing import TYPE_CHECKING

from rulec.automata.bundle.compiled_rulebook import CompiledRule, TooLargeRule
from rulec.diagnostics import first_of
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.report.text.terminal_text import broken, counted, cut, mirrored, table_lines, visible
from rulec.report.verdicts import verdict_report
from rulec.report.verdicts.violation_tally import RuleOutcome, ViolationTally
from rulec.vocabulary import Enumeration, Quantity

if TYPE_CHECKING:
    from rulec.report.findings.verdict_finding import VerdictFinding

MOST_SHOWN = 3
"""Number of drives of a violated rule that are shown; the findings have all of them."""

MOST_NAMES = 4
"""Number of names listed in a line."""

MOST_COUNTED = 2
"""Number of missing words whose rules are counted."""

MOST_UNJUDGED = 100
"""Number of rules that ``--why`` names as not judged; JSON has all of them."""

INDENT = "  "

Rule = CompiledRule | TooLargeRule


@dataclass(frozen=True, slots=True)
class AnswerLayout:
    """The width of the answer in characters, and whether it says ``why`` something is unknown.

    ``source`` are the arguments that name the recording and the rulebook in another command;
    without them, it does not say how to see more.
    """

    width: int
    why: bool = False
    source: tuple[str, ...] = ()


class RecordingAnswer:
    """The verdicts on a recording's drives as text.

    ``shown`` are the first findings of each violated rule, at most ``MOST_SHOWN``.
    """

    def __init__(
        self,
        verdicts: RecordingVerdicts,
        tally: ViolationTally,
        shown: Mapping[str, Sequence[VerdictFinding]],
        layout: AnswerLayout,
    ) -> None:
        self._verdicts, self._tally, self._shown, self._layout = verdicts, tally, shown, layout
        own = verdicts.rules
        rules: Sequence[Rule] = [*own.rules, *own.too_large]
        self._rules = {rule.name: rule for rule in rules}
        self._judged = tally.with_answer

    def as_text(self) -> str:
        """What was found, in how much nothing was found, and what could not be judged."""
        lines = [*self._head(), *self._found(), *self._nothing_found()]
        lines += [*self._not_judged(), *self._drives_not_judged(), *self._faults()]
        lines += self._reasons() if self._layout.why else self._ways_on()
        return "\n".join(map(visible, lines))

    def _wrapped(self, text: str, indent: str = "", most: int | None = None) -> list[str]:
        """A text in lines; of more than ``most`` lines, the last one ends in an ellipsis."""
        width = self._layout.width
        lines = broken(text, width, indent, indent + INDENT)
        if most is None or len(lines) <= most:
            return lines
        last = broken(lines[most - 1], width - len(" …"), later=indent + INDENT)[0]
        return [*lines[: most - 1], cut(f"{last} …", width)]

    def _head(self) -> Iterator[str]:
        recording, n_drives = self._verdicts.recording, counted(self._tally.judged, "drive")
        yield from self._wrapped(f"{recording.name}: {n_drives} in steps of {recording.step_s:g} s")
        if self._verdicts.mirrored:
            yield from self._wrapped(mirrored(str(recording.side)), INDENT)
        elif recording.side is None and self._verdicts.rules.traffic == "left":
            text = "the side of traffic is unknown: assumed to be the left"
            yield from self._wrapped(text, INDENT)
        if self._verdicts.defaults:
            text = "assumed: defaults, and that nothing comes after the recording's end"
            yield from self._wrapped(text, INDENT)

    def _found(self) -> Iterator[str]:
        """Each violated rule with its first drives, hard rules first."""
        by_strength: dict[str, list[str]] = {"hard": [], "soft": []}
        for rule in self._tally.first_s:
            by_strength[self._rules[rule].strength].append(rule)
        for strength, rules in by_strength.items():
            drives = {drive for rule in rules for drive in self._tally.first_s[rule]}
            if drives:
                yield f"{counted(len(drives), 'drive')} broke a {strength} rule"
            for rule in rules:
                yield from self._violated(rule)

    def _violated(self, name: str) -> Iterator[str]:
        rule = self._rules[name]
        assert isinstance(rule, CompiledRule), "only what was compiled is judged"
        drives = self._tally.first_s[name]
        title = verdict_report.short_title(rule)
        yield from self._wrapped(f"{title}: {counted(len(drives), 'drive')}", INDENT, most=1)
        defaults = self._verdicts.by_default(self._tally.words or frozenset())[name]
        if rule.says:
            yield from self._wrapped(rule.says, 2 * INDENT, most=1 if defaults else 2)
        if defaults:
            text = f"by default: {first_of(defaults, MOST_NAMES)}"
            yield from self._wrapped(text, 2 * INDENT, most=1)
        every = self._shown.get(name, ())
        n_violations = sum(map(len, self._tally.causes[name].values()))
        shown = every if n_violations <= MOST_SHOWN else every[: MOST_SHOWN - 1]
        rows = [(one.vehicle, one.when, one.in_short) for one in shown]
        for line in table_lines(rows, indent=2 * INDENT, right=(0,)) if rows else ():
            yield cut(line.rstrip(), self._layout.width)
        named = {one.vehicle for one in shown}
        others = sorted((at, drive) for drive, at in drives.items() if drive not in named)
        if others:
            text = f"and {len(others):,} more: {first_of([x for _, x in others], MOST_NAMES)}"
            yield from self._wrapped(text + self._one_cause(name), 2 * INDENT, most=1)
        elif n_violations > len(shown):
            yield f"{2 * INDENT}and {n_violations - len(shown):,} more of the same drives"

    def _one_cause(self, rule: str) -> str:
        """The objects that most violations of a rule are about, if several are."""
        causes = self._tally.causes[rule].items()
        about, drives = max(causes, key=lambda cause: len(cause[1]))
        is_one = len(drives) > 1 and about
        return f"; {len(drives):,} are about {', '.join(about)}" if is_one else ""

    def _nothing_found(self) -> Iterator[str]:
        tally = self._tally
        if not tally.judged:
            return
        rest = tally.judged - len({drive for times in tally.first_s.values() for drive in times})
        n_judged = len(self._judged)
        if n_judged < len(self._rules) or tally.open_rules:
            found = f"nothing found in {counted(n_judged, 'judged rule')}"
        else:
            found = f"nothing against {'the rule' if n_judged == 1 else f'all {n_judged:,} rules'}"
        found = f"{counted(rest, 'drive')}: {found}" if rest else f"else {found}"
        some = len(self._judged.intersection(tally.open_rules))
        never = len(tally.open_rules.keys() - self._judged)
        found += f", {some:,} of them open in some drive" if some else ""
        found += f"; {counted(never, 'rule')} open in every drive" if never else ""
        yield from self._wrapped(found)

    def _not_judged(self) -> Iterator[str]:
        """How many rules are not judged, and which words would help most."""
        names = self._unjudged()
        if not names:
            return
        text = f"{len(names):,} of {counted(len(self._rules), 'rule')} not judged"
        text += " in some drive" if any(self._tally.judged_in[name] for name in names) else ""
        left = {name: tuple(self._tally.untold.get(name, ())) for name in names}
        parts: list[str] = []
        while left and len(parts) < MOST_COUNTED:
            words = Counter(word for own in left.values() for word in own)
            if not words:
                break
            word, number = words.most_common(1)[0]
            parts.append(f"{number:,} want {word}" if not parts else f"{number:,} {word}")
            left = {name: own for name, own in left.items() if word not in own}
        if left and parts:
            parts.append(counted(len(left), "other"))
        yield from self._wrapped(f"{text}: {', '.join(parts)}" if parts else text)
        yield from self._would_help(names)

    def _would_help(self, names: Sequence[str]) -> Iterator[str]:
        """The assumption of one value that lets most rules be judged."""
        lacking = [tuple(self._tally.untold.get(name, ())) for name in names]
        alone = Counter(words[0] for words in lacking if len(words) == 1)
        declared = self._verdicts.rules.vocabulary.declarations
        for word, number in alone.most_common():
            item = declared.get(word)
            if item is None or item.parameters or isinstance(item, Quantity):
                continue
            values = item.values if isinstance(item, Enumeration) else ("true", "false")
            value = f"`--assume {word}=VALUE`" if self._layout.source else f"a known {word}"
            text = f"{value} would let {number:,} of them be judged: {', '.join(values)}"
            yield from self._wrapped(text, INDENT, most=1)
            return

    def _unjudged(self) -> list[str]:
        with_any = self._judged | {*self._tally.open_rules}
        return [name for name in self._rules if name not in with_any] if self._tally.judged else []

    def _drives_not_judged(self) -> Iterator[str]:
        reasons: dict[str, list[str]] = {}
        for no_drive in self._tally.not_judged:
            reasons.setdefault(no_drive.why, []).append(no_drive.ego)
        most = None if self._layout.why else 1
        for why, egos in list(reasons.items())[:most]:
            text = f"not judged: {first_of(egos, MOST_NAMES)}: {why}"
            yield from self._wrapped(text, most=most)
        if most and len(reasons) > most:
            rest = sum(len(egos) for egos in list(reasons.values())[most:])
            yield f"not judged: {counted(rest, 'vehicle')} more for other reasons"

    def _faults(self) -> Iterator[str]:
        faults = [*self._tally.faults]
        if faults:
            more = f", and {len(faults) - 1:,} more" if len(faults) > 1 else ""
            yield from self._wrapped(f"fault: {faults[0]}{more}", most=2)

    def _ways_on(self) -> Iterator[str]:
        """How to see more."""
        remarks = self._verdicts.recording.remarks
        if remarks:
            more = f" (and {len(remarks) - 1:,} more)" if len(remarks) > 1 else ""
            yield from self._wrapped(f"note{more}: {remarks[0]}", most=1)
        if not self._layout.source:
            return
        ways = ["--explain 1 (the first one)"] if self._tally.first_s else []
        if self._unjudged() or self._tally.open_rules or remarks:
            ways.append("--why (what is open or not judged)")
        if ways:
            yield from self._wrapped(f"more: {', '.join(ways)}")
        if self._tally.first_s:
            (drive, *_) = next(iter(self._tally.first_s.values()))
            ego = drive.partition("#")[0]
            yield from self._command(
                ["draw", "drive", *self._layout.source, "--ego", ego, "-o", "drive.html"]
            )

    def _command(self, words: Sequence[str]) -> list[str]:
        """A command that can be copied, in at most three lines; none if it does not fit."""
        lines, parts = ["see it: rulec"], [quote(word) for word in words]
        if len(whole := " ".join([*lines, *parts])) <= self._layout.width:
            return [whole]
        for part in parts:
            # An option stays beside its value
            whole = f"{lines[-1]} {part}"
            if part.startswith("-") or len(whole) + len(" \\") <= self._layout.width:
                lines[-1] = whole
            else:
                *before, option = lines[-1].rsplit(" ", 1)
                if option.startswith("-") and before:
                    lines[-1:] = [*before, f"{INDENT}{option} {part}"]
                else:
                    lines.append(INDENT + part)
        lines[:-1] = [f"{line} \\" for line in lines[:-1]]
        fits = len(lines) <= 3 and max(map(len, lines)) <= self._layout.width
        return lines if fits else []

    def _reasons(self) -> Iterator[str]:
        """Every rule once: judged, open or not judged, for which words; and all notes."""
        verdicts, tally = self._verdicts, self._tally
        by_outcome: dict[RuleOutcome, list[str]] = {}
        for rule, outcome in tally.outcomes(self._rules).items():
            by_outcome.setdefault(outcome, []).append(rule)
        about = ", without an opportunity to violate them (as in `rulec rates`)"
        more: dict[RuleOutcome, str] = {"nothing found": "", "idle": about}
        more["kept regardless"] = " of the words that the recording lacks"
        for outcome, what in more.items():
            if names := by_outcome.get(outcome):
                if outcome == "nothing found" and tally.opportunities:
                    what = ", in so many opportunities"
                    names = [f"{name} ({tally.opportunities[name]:,})" for name in names]
                yield from self._wrapped(f"{outcome}{what}: {', '.join(names)}")
        vocabulary = verdicts.rules.vocabulary
        # It may also depend on the types that participants of unknown type have
        order = [*vocabulary.declarations, *vocabulary.types]
        if open_rules := by_outcome.get("open"):
            yield from self._wrapped(f"open in some drive: {', '.join(open_rules)}")
            words = sorted(tally.open_on, key=order.index)
            if words:
                yield from self._wrapped(f"depends on {', '.join(words)}", INDENT)
        yield from self._by_words(self._unjudged())
        defaults = verdicts.defaulted(tally.words or frozenset())
        if defaults:
            text = f"by default, as the recording does not say: {', '.join(defaults)}"
            yield from self._wrapped(text)
        for remark in verdicts.recording.remarks:
            yield from self._wrapped(f"note: {remark}")

    def _by_words(self, names: Sequence[str]) -> Iterator[str]:
        """The rules that cannot be judged, hard ones first, grouped by the missing words."""
        by_words: dict[tuple[str, tuple[str, ...]], list[str]] = {}
        ordered = sorted(names, key=lambda name: self._rules[name].strength != "hard")
        for name in ordered[:MOST_UNJUDGED]:
            reasons = [self._tally.reasons[name]] if name in self._tally.reasons else []
            words = tuple(self._tally.untold.get(name) or reasons)
            by_words.setdefault((self._rules[name].strength, words), []).append(name)
        if by_words:
            text = "not judged, for lack of (`rulec explain WORD` says what can provide a word):"
            yield from self._wrapped(text)
        for (strength, words), rules in by_words.items():
            kind = "" if strength == "hard" else " (soft)"
            text = f"{', '.join(words) or 'a reason'}: {', '.join(rules)}{kind}"
            yield from self._wrapped(text, INDENT)
        if len(names) > MOST_UNJUDGED:
            yield f"{INDENT}and {len(names) - MOST_UNJUDGED:,} more"


def summary(tally: ViolationTally) -> str:
    """The summary line of a run."""
    counts = {outcome: len(drives) for outcome, drives in tally.drives.items()}
    return verdict_report.summary(counts, len(tally.not_judged), "drive")
