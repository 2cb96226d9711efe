"""The drives of a recording written as traces, in one process or in several."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from typing import Any, TypeVar

from rulec.batch.batch_messages import process_lost
from rulec.batch.jobs import Jobs, LostTask
from rulec.batch.worker_pool import in_order
from rulec.diagnostics import SourceLocation
from rulec.extraction.selection import RequestedDrives, SelectedDrives, selected_drives
from rulec.extraction.traces.recorded_drive import Drive
from rulec.recordings.recording_files import read_recording
from rulec.recordings.recording_format import RecordingSource
from rulec.recordings.recording_messages import NOT_IN_RECORDING
from rulec.rulebook.rulebook_model import Traffic
from rulec.trace import Trace
from rulec.trace.formats.trace_files import Format, with_bounds, write_traces
from rulec.trace.vocabulary_projection import MEASURED
from rulec.vocabulary import Vocabulary

Piece = TypeVar("Piece")


@dataclass(frozen=True)
class WrittenDrives:
    """What to write: which drives of a recording, with which vocabulary and in which format.

    Each process reads the recording once, when it needs it. All members but the fields raise
    RulecError if the recording cannot be read or contains no drive.
    """

    source: RecordingSource
    request: RequestedDrives
    vocabulary: Vocabulary | None
    traffic: Traffic
    form: Format

    def __getstate__(self) -> dict[str, Any]:
        """The fields without what was read, which another process reads faster than it is sent."""
        read = ("selected", "kinds", "head")
        return {name: value for name, value in self.__dict__.items() if name not in read}

    @cached_property
    def selected(self) -> SelectedDrives:
        """The drives to write."""
        file = str(self.source.path)
        recording = read_recording(self.source)
        return selected_drives(recording, self.request, file, self.traffic, self.vocabulary)

    @cached_property
    def kinds(self) -> dict[str, type]:
        """The type of each name that occurs in the drives."""
        kinds = with_bounds(self.selected.kinds(), MEASURED)
        if not kinds:
            message = "nobody in this recording drives on a lane"
            raise NOT_IN_RECORDING.error(SourceLocation(str(self.source.path)), message)
        return kinds

    def traces(self, ego: str) -> Iterator[Trace]:
        """The drives of one vehicle."""
        for drive in self.selected.of(ego):
            if isinstance(drive, Drive):
                yield drive.trace

    def written(self, ego: str) -> Iterator[bytes]:
        """The drives of one vehicle, each as the bytes that follow the head in a file."""
        for trace in self.traces(ego):
            yield self._bytes(trace)[len(self.head) :]

    @cached_property
    def head(self) -> bytes:
        """The bytes that a file begins with."""
        return self._bytes()

    def _bytes(self, *traces: Trace) -> bytes:
        stream = BytesIO()
        write_traces(traces, stream, "", self.form, self.kinds, partial=True)
        return stream.getvalue()


def in_vehicle_order(
    work: Callable[[str], Iterator[Piece]],
    drives: WrittenDrives,
    jobs: Jobs,
    tell: Callable[[int], object],
    lost: Callable[[str, int | None], object],
) -> Generator[Piece, None, None]:
    """What ``drives.traces`` or ``drives.written`` gives for each vehicle, in the vehicles' order.

    Do not write bytes for Parquet, whose rows have to be together. ``tell`` is called with the
    number of finished vehicles; ``lost`` with a vehicle whose process was killed, and the signal,
    before the vehicle is repeated. Raises RulecError R0708 if the process is killed again.
    """
    for _, piece in in_order(work, drives.selected.egos, jobs, tell, lost):
        if isinstance(piece, LostTask):
            raise process_lost(str(drives.source.path), piece.signal_number, "read")
        yield piece
