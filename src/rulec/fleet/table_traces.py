"""Judge traces in tables, as rows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import contained
from rulec.fleet.drive_rows import DriveRows
from rulec.fleet.finding_columns import Row
from rulec.fleet.fleet_messages import cut_drive
from rulec.fleet.table_kind import FILE, MAP, ROWS, SeenKeys, keys_of, lacking
from rulec.monitoring.assumptions import Assumptions
from rulec.monitoring.batch.batch_verify import Answer, Items, rulebook_for, verify_items
from rulec.monitoring.moments.drive_facts import DriveFacts, facts_of_many
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.report.findings.findings_of_traces import trace_findings
from rulec.report.findings.verdict_finding import VerdictFinding
from rulec.trace.formats import arrow as arrow_tables
from rulec.trace.formats.table_reader import OBJECT, OTHER, STEP, TRACE
from rulec.trace.trace_model import Trace


@dataclass(frozen=True, slots=True)
class TraceTableJudge:
    """Judges traces in tables; ``seen`` as in ``TrackTableJudge``."""

    to_rows: DriveRows
    assumed: Assumptions
    seen: SeenKeys | None

    def rows(self, table: Any) -> Iterator[Row]:
        """The rows of all traces, ordered by name.

        Raises RulecError R0709 for a trace that is cut, if tables are not grouped by trace.
        """
        own = [name for name in keys_of(table.column_names, "traces") if name != TRACE]
        order = [TRACE, STEP, *(x for x in (OBJECT, OTHER) if x in table.column_names)]
        for key, rows in arrow_tables.groups(table, own, order):
            yield from self._of_source(rows, dict(zip(own, key, strict=True)))

    def _of_source(self, rows: Any, own: Mapping[str, str]) -> Iterator[Row]:
        """The rows of the traces from one file and recording."""
        outlines, some_unread = (
            arrow_tables.trace_outlines(rows),
            arrow_tables.not_utf8(rows, rows.column_names),
        )
        is_counted = ROWS in rows.column_names
        cut = []
        for number, outline in enumerate(outlines):
            lacks = outline.lacks
            if not lacks and is_counted:
                lacks = lacking(rows.slice(outline.first, outline.rows), outline.rows)
            if self.seen is not None:
                content = (outline.rows, outline.states)
                if not lacks and self.seen.is_other((*own.values(), outline.name), content):
                    lacks = "other rows of it came before"
                if lacks:
                    raise cut_drive(f"trace `{outline.name}`", lacks, [*own, TRACE])
            if some_unread and not lacks:
                lacks = arrow_tables.not_utf8(
                    rows.slice(outline.first, outline.rows), rows.column_names
                )
            if lacks:
                yield self.to_rows.of_nothing({**own, "vehicle": outline.name}, lacks)
                cut.append(number)
        rest = arrow_tables.without_rows(rows, [outlines[number] for number in cut])
        whole = [whole_trace for number, whole_trace in enumerate(outlines) if number not in {*cut}]
        others = [name for name in (MAP, ROWS) if name in rest.column_names]
        yield from self._judged(rest.drop_columns(others), whole, own)

    def _judged(self, rows: Any, outlines: list[Any], own: Mapping[str, str]) -> Iterator[Row]:
        to_rows, waiting = self.to_rows, iter(outlines)
        try:
            with contained():
                chunks = (
                    arrow_tables.traces_of_table(rows, own.get(FILE, "") or "the table")
                    if outlines
                    else ()
                )
                for chunk in chunks:
                    yield from self._of_chunk(chunk, waiting, own)
        except RulecError as error:
            for outline in waiting:
                yield to_rows.of_nothing({**own, "vehicle": outline.name}, _why(error))

    def _of_chunk(
        self, chunk: Items, waiting: Iterator[Any], own: Mapping[str, str]
    ) -> Iterator[Row]:
        to_rows = self.to_rows
        for traces, answers in verify_items(self.assumed.of(chunk), to_rows.rules):
            for place, row in enumerate(self._with_facts(traces, answers)):
                named = {**own, "vehicle": next(waiting).name}
                if isinstance(row, str):
                    yield to_rows.of_nothing(named, row)
                    continue
                verdict, facts = row
                findings = self._findings(traces, place, verdict, own)
                yield from to_rows.of_trace(facts, verdict, named, findings)

    def _with_facts(
        self, traces: Items, answers: Iterable[Answer]
    ) -> list[tuple[Verdict, DriveFacts] | str]:
        """For each trace its verdict and the facts needed for rates, or why it has none."""
        # Only the reason, not the whole message: a table may contain as many reasons as rows.
        short = [
            _why(answer.error) if isinstance(answer, NotJudged) else answer for answer in answers
        ]
        verdicts = [None if isinstance(answer, str) else answer for answer in short]
        facts = iter(facts_of_many(traces, verdicts, self.to_rows.rules))
        return [answer if isinstance(answer, str) else (answer, next(facts)) for answer in short]

    def _findings(
        self, traces: Items, place: int, verdict: Verdict, own: Mapping[str, str]
    ) -> list[VerdictFinding]:
        """The findings of a trace; the trace is built only if there are any."""
        if not verdict.violations and not verdict.open:
            return []
        trace = traces[place]
        assert isinstance(trace, Trace), "it has been judged"
        used = rulebook_for(traces, place, self.to_rows.rules)
        return list(trace_findings(own.get(FILE, ""), trace, verdict, used, []))


def _why(error: RulecError) -> str:
    return error.diagnostics[0].message
