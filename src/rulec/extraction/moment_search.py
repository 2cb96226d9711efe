"""The moments at which a formula holds in recorded drives and in traces."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.fault_messages import contained, fault_of
from rulec.extraction.selection import RequestedDrives, selected_drives
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.logic.free_names import names_in
from rulec.monitoring.assumptions import Assumptions
from rulec.monitoring.moments.formula_moments import Moment, moments
from rulec.monitoring.state_validation import check_objects, check_states, check_told
from rulec.monitoring.told_names import names_behind
from rulec.recordings.recording import Recording
from rulec.rulebook.query_model import FormulaQuery
from rulec.trace import Trace
from rulec.trace.trace_arrays import TraceArrays
from rulec.trace.trace_model import check_trace
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class DriveMoments:
    """The moments of one vehicle or trace in a recording of a file.

    State 0 is at ``start_s`` (s); states are ``step_s`` (s) apart.
    """

    __repr__ = short_repr

    file: str
    recording: str
    vehicle: str
    start_s: float
    step_s: float
    moments: Sequence[Moment]

    def time_s(self, state: int) -> float:
        """The time (s) of a state."""
        return round(self.start_s + state * self.step_s, 9)


Look: TypeAlias = Callable[[Trace | TraceArrays, FormulaQuery], Sequence[Moment]]
"""What is looked for in a drive: the moments of the formula, or the values of a word."""


def in_recordings(
    recordings: Iterable[Recording],
    query: FormulaQuery,
    wanted: RequestedDrives,
    file: str,
    look: Look = moments,
) -> Iterator[DriveMoments | RulecError]:
    """The moments of each drive of several recordings; see ``in_recording``."""
    for recording in recordings:
        yield from in_recording(recording, query, wanted, file, look)


def in_recording(
    recording: Recording,
    query: FormulaQuery,
    request: RequestedDrives,
    file: str,
    look: Look = moments,
) -> Iterator[DriveMoments | RulecError]:
    """The moments of each drive, with each requested vehicle as ego in turn.

    A fault of rulec takes the place of a drive that it has cost.

    Raises RulecError R0612 for a vehicle that the recording does not contain.
    """
    selected = selected_drives(
        recording,
        request,
        file,
        traffic=query.traffic,
        vocabulary=query.vocabulary,
        names=names_behind(frozenset(names_in(query.rule.formula)), query.vocabulary),
    )
    for ego in selected.egos:
        for drive in selected.of(ego):
            if isinstance(drive, NoDrive):
                if drive.fault is not None:
                    yield drive.fault
                continue
            arrays = drive.arrays
            yield from dict.fromkeys(arrays.faults.values())
            if any(arrays.faults):
                continue  # it reads a word that was lost
            try:
                found = look(arrays, query)
            except Exception as problem:
                yield fault_of(problem, f"drive of `{arrays.id}`")
                continue
            yield DriveMoments(
                file=file,
                recording=recording.name,
                vehicle=arrays.id,
                start_s=drive.start_s,
                step_s=arrays.step_s,
                moments=found,
            )


def in_traces(
    traces: Iterable[Trace | RulecError],
    query: FormulaQuery,
    assumed: Assumptions,
    file: str,
    look: Look = moments,
) -> Iterator[DriveMoments | RulecError]:
    """The moments of each trace, or the error where a trace cannot be searched."""
    for item in traces:
        if isinstance(item, RulecError):
            yield item
            continue
        try:
            with contained(f"trace `{item.id}`", SourceLocation(file)):
                yield in_trace(item, query, assumed, file, look)
        except RulecError as error:
            yield error


def in_trace(
    trace: Trace,
    query: FormulaQuery,
    assumed: Assumptions,
    file: str,
    look: Look = moments,
) -> DriveMoments:
    """The moments of a trace. Raises RulecError R0501 to R0506 for an invalid trace."""
    trace = assumed.applied(trace) if assumed else trace
    check_trace(trace)
    check_objects(trace.objects, query.vocabulary, trace.place)
    check_told(trace.told, query.vocabulary, trace.place)
    where = "state {}".format
    check_states(trace.states, trace.objects, query.vocabulary, where, trace.place)
    return DriveMoments(
        file=file,
        recording="",
        vehicle=trace.id,
        start_s=0.0,
        step_s=trace.step_s,
        moments=look(trace, query),
    )
