"""Runs over fleets that are killed at some moment: by themselves, so that it is always the same."""

import os
import signal
import sys
from dataclasses import dataclass
from pathlib import Path

from pyarrow import parquet

from rulec.fleet.runs.fleet_run import FleetSettings, run_fleet
from rulec.fleet.runs.unit_work import UnitWorker


@dataclass(frozen=True)
class DyingWorker(UnitWorker):
    """A worker whose process is killed at the first unit of all."""

    def judged(self, unit):
        try:
            # Of two processes that begin at once one alone makes it
            (self.folder.path / "first.begun").touch(exist_ok=False)
        except FileExistsError:
            return super().judged(unit)
        return os.kill(os.getpid(), signal.SIGKILL)


def run_until(moment, inputs, rules, folder, settings: FleetSettings):
    """Run over a fleet, and be killed before or after the so many-th thing that is written."""
    left = int(moment)

    def come() -> None:
        nonlocal left
        if not left:
            os.kill(os.getpid(), signal.SIGKILL)
        left -= 1

    def counted(function):
        def call(*arguments, **options):
            come()
            result = function(*arguments, **options)
            come()
            return result

        return call

    Path.replace = counted(Path.replace)
    parquet.ParquetWriter.write_table = counted(parquet.ParquetWriter.write_table)
    run_fleet(inputs, rules, folder, settings)


if __name__ == "__main__":
    from rulec.extraction.selection import RequestedDrives
    from rulec.recordings.recording_format import RecordingSource

    number, source, compiled, target = sys.argv[1:]
    usual = FleetSettings(RequestedDrives(), RecordingSource(Path("-")))
    run_until(number, [source], compiled, Path(target), usual)
