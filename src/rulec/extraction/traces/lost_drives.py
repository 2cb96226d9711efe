"""What a fault of rulec costs: a drive, or nothing if each of several drives can be made alone."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from rulec.diagnostics.fault_messages import fault_of
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.trace.end_to_end import UnlikeDrivesError


def lost_drive(ego: str, problem: Exception) -> NoDrive:
    """The vehicle without the drive that an exception has cost; raises what is no fault."""
    fault = fault_of(problem, f"drive of `{ego}`")
    return NoDrive(ego, fault.diagnostics[0].message, fault)


def made_together(
    names: Iterable[str],
    make_all: Callable[[], Sequence[Drive]],
    make: Callable[[int], Drive | NoDrive],
) -> Sequence[Drive | NoDrive]:
    """The drives of ``make_all``; none if their signals differ.

    After a fault there, each made by its number. If that costs none of them anything, the first one
    still says the fault.
    """
    try:
        return make_all()
    except UnlikeDrivesError:
        return ()
    except Exception as problem:
        drives = [_made(make, number, name) for number, name in enumerate(names)]
        if not any(isinstance(drive, NoDrive) or drive.arrays.faults for drive in drives):
            first = drives[0]
            assert isinstance(first, Drive)
            fault = fault_of(problem, "drives laid end to end")
            drives[0] = replace(first, arrays=replace(first.arrays, faults={"": fault}))
        return drives


def _made(make: Callable[[int], Drive | NoDrive], number: int, name: str) -> Drive | NoDrive:
    try:
        return make(number)
    except Exception as problem:
        return lost_drive(name, problem)
