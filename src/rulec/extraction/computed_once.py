"""Functions of a drive's context that compute their results only once for whatever these are of.

Results are shared, so callers must not change them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Protocol, TypeVar

from rulec.extraction.drive_context import DriveContext

Found = TypeVar("Found")


class Once(Protocol):
    """Makes a function compute its result once."""

    def __call__(self, compute: Callable[[DriveContext], Found]) -> Callable[[DriveContext], Found]:
        """The function that does so."""


def _once(kept_by: Callable[[DriveContext], dict[Any, Any]], *, along_road: bool = False) -> Once:
    """Results are kept in a dictionary of the context's, with ``along_road`` one for each road."""

    def once_for(compute: Callable[[DriveContext], Found]) -> Callable[[DriveContext], Found]:
        @wraps(compute)
        def found(context: DriveContext) -> Found:
            known, key = kept_by(context), (compute, context.road) if along_road else compute
            if key not in known:
                known[key] = compute(context)
            value: Found = known[key]
            return value

        return found

    return once_for


once = _once(lambda context: context.computed)
"""For a function of a context."""

once_a_recording = _once(lambda context: context.surroundings.computed)
"""For one of only the recording and its thresholds.

The recording's surroundings keep the result; they belong to one side of traffic and one choice of
thresholds.
"""

once_a_map = _once(lambda context: context.surroundings.of_map)
"""For one of only the recording's map."""

once_a_road = _once(lambda context: context.surroundings.of_map, along_road=True)
"""For one of only the map and one road."""
