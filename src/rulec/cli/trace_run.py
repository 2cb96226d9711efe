"""Traces of files, judged one after the other."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from io import UnsupportedOperation
from typing import IO, Any, cast

from rulec.cli import lazy_imports as lazy
from rulec.cli.options.standard_input import input_stream
from rulec.cli.verdict_run import VerdictRun
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.diagnostic import with_place
from rulec.diagnostics.fault_messages import contained, fault_of
from rulec.monitoring.assumptions import Assumptions
from rulec.monitoring.batch.batch_verify import Items, rulebook_for, step_of, verify_items
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.report.findings.verdict_finding import RecordingFindings, VerdictFinding
from rulec.report.text.console import page_width, print_remark, progress
from rulec.report.verdicts import verdict_report
from rulec.report.verdicts.state_times import StateTimes
from rulec.resource_limits import REFUSED, BudgetSpentError
from rulec.trace import Trace
from rulec.trace.formats.trace_files import Format, format_of, read_chunks
from rulec.trace.trace_messages import SAME_ID

Answer = tuple[Sequence[Trace | RulecError], int, Verdict | NotJudged]
"""A sequence of traces, an index in it, and that trace's verdict or why there is none."""

AnswerWithFacts = tuple[Answer, "lazy.DriveFacts | None"]
"""An answer with the facts for rows of drives, if they are wanted."""

_GOES_ON = (
    "rulec: a trace that is cut goes on unseen, and so does one in seconds that does not say how "
    "it ends; `--end complete` judges both as over"
)


@dataclass(kw_only=True)
class TraceRun(VerdictRun):
    """Judges the traces of files; the first ``to_explain`` violations of each are explained."""

    to_explain: int
    every_part: bool
    opened: bool = False
    pending: bool = False

    def __post_init__(self) -> None:
        self._names = [rule.name for rule in self.rules.rules]

    def files(self, files: Sequence[str], form: Format | None, assumed: Assumptions) -> None:
        """Judge the traces of files, with one summary for all of them."""
        for file in files:
            findings: list[VerdictFinding] = []
            rows: list[Mapping[str, object]] = []
            left, judged_traces = self.to_explain, list[str]()
            ids: set[str] | None = set()
            for judged, facts in self._answers(file, form, assumed):
                ids = self._ids(ids, file, judged)
                answer = judged[-1]
                before = len(findings)
                try:
                    if isinstance(answer, NotJudged):
                        self._not_judged(file, answer, findings)
                    else:
                        left -= self._judged(file, judged, left, findings)
                        judged_traces.append(answer.trace)
                except Exception as problem:
                    fault = fault_of(problem, "not judged", SourceLocation(file))
                    answer = NotJudged(answer.trace, fault)
                    self._not_judged(file, answer, findings)
                rows += self._rows(file, answer, facts, findings[before:])
            if self.to.writers:
                found = (tuple(judged_traces), tuple(findings), tuple(rows))
                self.to.add(RecordingFindings(file, "", *found))
        if self.total.judged or self.opened:
            self.to.text(verdict_report.summary(self.total.outcomes, self.total.not_judged))
        if self.pending and assumed.ends is None:
            print_remark(_GOES_ON)

    def _ids(self, ids: set[str] | None, file: str, answer: Answer) -> set[str] | None:
        """A file's ids so far; None once a duplicate has been reported."""
        traces, place, verdict = answer
        if ids is None or verdict.trace is None:
            return ids
        if verdict.trace not in ids:
            ids.add(verdict.trace)
            return ids
        trace = traces[place]
        warning = SAME_ID.at(
            trace.place if isinstance(trace, Trace) else None,
            f"another trace of `{file}` has the id `{verdict.trace}`, too",
            help="give each trace an id of its own: verdicts and findings name it by that alone",
            severity="warning",
        )
        self.complaints.add(RulecError(warning))
        return None

    def _rows(
        self,
        file: str,
        answer: Verdict | NotJudged,
        facts: lazy.DriveFacts | None,
        findings: Sequence[VerdictFinding],
    ) -> Iterator[Mapping[str, object]]:
        """The rows of a trace and of its findings, if they are wanted."""
        own = {"file": file, "vehicle": answer.trace or ""}
        if self.to.to_rows is None:
            return
        if isinstance(answer, NotJudged):
            yield self.to.to_rows.of_nothing(own, answer.error.diagnostics[0].message)
        elif facts is not None:
            yield from self.to.to_rows.of_trace(facts, answer, own, findings)

    def _not_judged(self, file: str, answer: NotJudged, findings: list[VerdictFinding]) -> None:
        self.total.not_judged += 1
        self.complete = False
        self.complaints.add(answer.error)
        if self.to.lines:
            self.to.line(lazy.verdict_json.not_judged_as_json(answer, self.rules.name))
        if self.to.writers:
            findings.append(lazy.not_judged_trace(file, answer, self.rules.name))

    def _judged(self, file: str, answer: Any, left: int, findings: list[VerdictFinding]) -> int:
        """Print a verdict; returns the number of violations explained."""
        traces, place, verdict = answer
        self.total.add_trace(verdict, self._names)
        for fault in verdict.faults:
            self.complete = False
            self.complaints.add(with_place(fault, SourceLocation(file)))
        self.open_hard |= any(result.strength == "hard" for result in verdict.open)
        self.judged |= len(verdict.not_judged) < max(len(self._names), 1)
        says = bool(verdict.violations or verdict.open or verdict.not_judged)
        if not says and not self.to.lines:
            return 0
        used = rulebook_for(traces, place, self.rules)
        explained: list[lazy.Explanation] = []
        # Traces of a table are only made on access.
        if left and verdict.violations:
            trace = cast("Trace", traces[place])
            explained = [
                lazy.explain(violation, trace, used) for violation in verdict.violations[:left]
            ]
        if self.to.lines:
            self.to.line(lazy.verdict_json.as_json(verdict, used, explained))
        if says and self.to.texts:
            most, width = verdict_report.MOST_VIOLATIONS, page_width()
            times = StateTimes(step_s=step_of(traces, place))
            tables: list[str] = []
            if explained:
                tables = lazy.tables(
                    explained[:most], used, width=width, every_part=self.every_part, times=times
                )
            text = verdict_report.as_text(verdict, used, tables, width=width, times=times)
            self.to.text(text)
            shown = verdict.open[:most]
            self.pending |= any("not over" in result.because for result in shown)
        if self.to.writers:
            findings += lazy.trace_findings(file, traces[place], verdict, used, explained)
        return len(explained)

    def _answers(
        self, file: str, form: Format | None, assumed: Assumptions
    ) -> Iterator[AnswerWithFacts]:
        try:
            place = SourceLocation(file)
            with input_stream(file) as (stream, name), contained("not judged", place):
                self.opened = True
                form = form or (format_of(file) if name == file else "jsonl")
                yield from self._in_stream(stream, name, form, assumed)
        except BudgetSpentError:
            raise
        except RulecError as error:
            yield ([error], 0, NotJudged(None, error)), None

    def _in_stream(
        self, stream: IO[bytes], name: str, form: Format, assumed: Assumptions
    ) -> Iterator[AnswerWithFacts]:
        """Answers of a stream. Raises RulecError R0718 for too many refused traces in a row."""
        size = None if name == "standard input" else _size(stream)
        refused = 0
        with progress(f"judging {name}", size) as tell:
            for chunk in read_chunks(stream, name, form):
                for judged, facts in self._in_chunk(assumed.of(chunk)):
                    answer = judged[-1]
                    refused = refused + 1 if isinstance(answer, NotJudged) else 0
                    if isinstance(answer, NotJudged):
                        REFUSED.within(refused, answer.error.diagnostics[0].place, name)
                    yield judged, facts
                if size is not None:
                    tell(stream.tell())

    def _in_chunk(self, items: Items) -> Iterator[AnswerWithFacts]:
        judge = partial(verify_items, rulebook=self.rules)
        for traces, answers in judge(items):
            facts: Iterator[lazy.DriveFacts] = iter(())
            if self.to.to_rows is not None:
                answers = list(answers)
                verdicts = [x if isinstance(x, Verdict) else None for x in answers]
                facts = iter(lazy.facts_of_many(traces, verdicts, self.rules))
            for place, answer in enumerate(answers):
                own = next(facts, None) if isinstance(answer, Verdict) else None
                yield (traces, place, answer), own


def _size(stream: IO[bytes]) -> int | None:
    """The size of a file in bytes; None if it is compressed."""
    try:
        about = os.fstat(stream.fileno())
    except UnsupportedOperation:
        return None
    return about.st_size if stat.S_ISREG(about.st_mode) else None
