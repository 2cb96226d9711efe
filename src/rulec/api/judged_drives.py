"""What was found in drives or traces: verdicts by name, and findings as rows of a table."""

from __future__ import annotations

from abc import abstractmethod
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from rulec.api.pictures import drive_drawing, trace_drawing
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.diagnostics.argument_kinds import expected
from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.extraction.violation_evidence import explain_drive
from rulec.monitoring.batch.batch_verify import verify_many
from rulec.monitoring.explain.explanation import Explanation, explain
from rulec.monitoring.moments.opportunity_outcomes import opportunities_of
from rulec.monitoring.rulebook_edition import edition_of
from rulec.monitoring.verdict import NotJudged, Verdict, VerdictOutcome, Violation, with_law
from rulec.recordings.recording import Recording
from rulec.report.findings.findings_of_drives import DriveFindings
from rulec.report.findings.findings_of_traces import not_judged_trace, trace_findings
from rulec.report.findings.verdict_finding import VerdictFinding
from rulec.report.pictures.drawing.picture_formats import Drawing, as_bytes
from rulec.report.text.terminal_text import counted
from rulec.report.verdicts import verdict_report
from rulec.report.verdicts.recording_answer import MOST_SHOWN, AnswerLayout, RecordingAnswer
from rulec.report.verdicts.violation_tally import RuleOutcome, ViolationTally
from rulec.trace import Trace
from rulec.value_display import Rows

if TYPE_CHECKING:
    from rulec.report.pictures.drawing.picture_formats import Format

Answer = Verdict | NotJudged | NoDrive
"""A verdict, or why there is none."""


class FindingRows(Rows, Sequence[VerdictFinding]):
    """Findings in the order of their drives, also as rows of a table."""

    def __init__(self, findings: Sequence[VerdictFinding]) -> None:
        self._findings = tuple(findings)

    def __len__(self) -> int:
        return len(self._findings)

    def __getitem__(self, number: Any) -> Any:
        found = self._findings[number]
        return FindingRows(found) if isinstance(number, slice) else found

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FindingRows) and self._findings == other._findings

    def __hash__(self) -> int:
        return hash(self._findings)

    def rows(self) -> list[dict[str, Any]]:
        """One row per finding, with its fields; several names are in one text."""
        return [
            {
                name: ", ".join(value) if isinstance(value, tuple) else value
                for name, value in finding.row().items()
            }
            for finding in self._findings
        ]

    def __repr__(self) -> str:
        rules = {finding.rule for finding in self._findings}
        return f"FindingRows({counted(len(self), 'finding')} of {counted(len(rules), 'rule')})"


class Judged(Rows, Mapping[str, Answer]):
    """The verdicts on drives or traces by name, and what was found in them.

    As a table it has a row for each violation. ``findings`` also has what is open or not judged.
    """

    noun = "trace"

    def __init__(self, rules: CompiledRulebook) -> None:
        self.rules = rules
        self.findings = FindingRows(())
        self._answers: dict[str, Answer] = {}

    def __getitem__(self, name: str) -> Answer:
        return self._answers[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._answers)

    def __len__(self) -> int:
        return len(self._answers)

    @property
    def violated(self) -> tuple[str, ...]:
        """The names of those that violate a hard rule."""
        return tuple([name for name, answer in self.items() if _outcome(answer) == "violated"])

    def violations(self) -> FindingRows:
        """The violations, those of soft rules as well."""
        return FindingRows([one for one in self.findings if one.outcome == "violated"])

    @property
    def worst(self) -> VerdictFinding | None:
        """The violation of a hard rule, else of a soft one, by the largest share of its limit.

        Those without a measure come last, of equal ones the first; None without violations.
        """
        return max(self.violations(), key=_badness, default=None)

    def rows(self) -> list[dict[str, Any]]:
        """One row per violation, with the fields of its finding."""
        return self.violations().rows()

    @abstractmethod
    def summary(self, width: int = 80) -> str:
        """What was found, as ``rulec verify`` prints it in a terminal of this width."""

    def explain(self, violation: VerdictFinding) -> Explanation:
        """Explain a violation state by state. Raises ValueError for a finding from elsewhere."""
        finding = expected("violation", "VerdictFinding", violation)
        answer = self._answers.get(finding.vehicle)
        for found in answer.violations if isinstance(answer, Verdict) else ():
            about = (*found.binding.values(),)
            if found.rule == finding.rule and finding.other[: len(about)] == about:
                return self._explained(found, finding.vehicle)
        raise ValueError(f"{finding!r} is no violation of these verdicts")

    @abstractmethod
    def _explained(self, violation: Violation, name: str) -> Explanation:
        """The explanation of a violation by the drive or trace of this name."""

    def __repr__(self) -> str:
        said = f"{len(self.violated):,} of {counted(len(self), self.noun)} broke a hard rule"
        return f"{type(self).__name__}({self.rules.name}: {said})"


def _outcome(answer: Answer) -> Any:
    return answer.outcome if isinstance(answer, Verdict) else None


def _badness(finding: VerdictFinding) -> tuple[bool, float]:
    sides = [abs(side) for side in (finding.value, finding.limit) if side is not None]
    largest = max(sides, default=0.0)
    share = finding.by / largest if finding.by is not None and largest else -1.0
    return finding.strength == "hard", share


class JudgedDrives(Judged):
    """What was found in the drives of a recording.

    Raises RulecError as ``RecordingVerdicts`` does.
    """

    noun = "drive"

    def __init__(
        self, recording: Recording, rules: CompiledRulebook, request: RequestedDrives, file: str
    ) -> None:
        verdicts = RecordingVerdicts(recording, rules, request, file, says_law=True)
        super().__init__(verdicts.rules)
        # Rounded once already, a bound would be taken for exact
        self._rulebook = rules
        self._recording, self._file = recording, file
        self._verdicts, self._tally = verdicts, ViolationTally()
        gathered = DriveFindings(verdicts, file)
        names = [rule.name for rule in verdicts.rules.rules]
        for found in verdicts.answers():
            gathered.add(found)
            self._tally.add(found, names)
            if isinstance(found, DriveVerdict):
                self._answers[found.drive.arrays.id] = found.answer
            else:
                self._answers[found.ego] = found
        self.findings = FindingRows(gathered.whole().findings)

    def summary(self, width: int = 80) -> str:
        """What was found, as ``rulec verify`` prints it in a terminal of this width."""
        shown: dict[str, list[VerdictFinding]] = {}
        for finding in self.violations():
            of_rule = shown.setdefault(finding.rule, [])
            of_rule += [finding] if len(of_rule) < MOST_SHOWN else []
        layout = AnswerLayout(expected("width", "int", width))
        answer = RecordingAnswer(self._verdicts, self._tally, shown, layout).as_text()
        return f"{verdict_report.headline(self.rules, width)}\n{answer}"

    def outcomes(self) -> dict[str, RuleOutcome]:
        """What became of each rule of the book in all drives together; it judges them again."""
        tally, own = ViolationTally(), self._again("")
        names = [rule.name for rule in own.rules.rules]
        for found in own.answers():
            met: Counter[str] | None = None
            if isinstance(found, DriveVerdict):
                every = opportunities_of(found.drive.arrays, own.rules, found.answer)
                met = Counter([opportunity.rule for opportunity in every])
            tally.add(found, names, met)
        return tally.outcomes([*names, *[rule.name for rule in own.rules.too_large]])

    def drive(self, name: str) -> Drive:
        """The drive of this name, with its trace. Raises KeyError."""
        for found in self._again(name).answers():
            if isinstance(found, DriveVerdict) and found.drive.arrays.id == name:
                return found.drive
        raise KeyError(name)

    def _explained(self, violation: Violation, name: str) -> Explanation:
        return explain_drive(violation, self.drive(name), self._rulebook)

    def draw(
        self,
        subject: str | VerdictFinding = "",
        form: Format = "svg",
        theme: Literal["auto", "light", "dark"] = "auto",
    ) -> bytes:
        """Draw a drive, or the moment of a violation, from above: the content of a file.

        Without a ``subject``, the drive that violates a rule first. Raises RulecError R0612 if
        there is no such drive.
        """
        name = subject.vehicle if isinstance(subject, VerdictFinding) else subject
        only, at_s = None, None
        if isinstance(subject, VerdictFinding):
            only, at_s = frozenset((subject.rule,)), subject.at_s
        drawing = drive_drawing(self._again(name), name, only, at_s)
        return as_bytes(drawing, form, self._verdicts.recording.name, theme)

    def _again(self, name: str) -> RecordingVerdicts:
        """The verdicts on one vehicle, with its drives; on all without a name."""
        vehicle, request = name.partition("#")[0], self._verdicts.request
        request = replace(request, egos=(vehicle,)) if vehicle else request
        return RecordingVerdicts(self._recording, self._rulebook, request, self._file)


class JudgedTraces(Judged):
    """What was found in traces."""

    def __init__(
        self, traces: Sequence[Trace | RulecError], rules: CompiledRulebook, file: str
    ) -> None:
        super().__init__(rules)
        law, findings = edition_of(rules), []
        self._traces: dict[str, Trace] = {}
        for trace, answer in zip(traces, verify_many(traces, rules), strict=True):
            judged = with_law(answer, law)
            name = self._free(judged.trace or "")
            self._answers[name] = judged
            if isinstance(trace, Trace) and isinstance(judged, Verdict):
                self._traces[name] = trace
                found = trace_findings(file, trace, judged, self._rules_of(name), [])
                findings += [replace(finding, vehicle=name) for finding in found]
            elif isinstance(judged, NotJudged):
                findings.append(not_judged_trace(file, judged, rules.name))
        self.findings = FindingRows(findings)

    def summary(self, width: int = 80) -> str:
        """What was found, as ``rulec verify`` prints it in a terminal of this width."""
        lines = [verdict_report.headline(self.rules, expected("width", "int", width))]
        outcomes: Counter[VerdictOutcome] = Counter()
        for name, answer in self.items():
            if isinstance(answer, Verdict):
                outcomes[answer.outcome] += 1
                if answer.violations:
                    own = self._rules_of(name)
                    lines.append(verdict_report.as_text(answer, own, width=width, doubts=False))
        lines.append(verdict_report.summary(outcomes, len(self) - outcomes.total()))
        return "\n".join(lines)

    def _rules_of(self, name: str) -> CompiledRulebook:
        """The rules at a trace's step."""
        return self.rules.fitted_to(self._traces[name].step_s)

    def _free(self, name: str) -> str:
        """A name that no earlier trace has, such as ``t (2)``."""
        number, free = 1, name
        while free in self._answers:
            number += 1
            free = f"{name} ({number})"
        return free

    def _explained(self, violation: Violation, name: str) -> Explanation:
        return explain(violation, self._traces[name], self._rules_of(name))

    def draw(self, subject: str | VerdictFinding, form: Format = "svg") -> bytes:
        """Draw a trace's values over time: the content of a file. Raises KeyError."""
        name = subject.vehicle if isinstance(subject, VerdictFinding) else subject
        trace = self._traces[name]
        drawing: Drawing = trace_drawing(trace, self.rules.fitted_to(trace.step_s))
        return as_bytes(drawing, form, name)
