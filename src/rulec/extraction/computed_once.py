"""Functions of a drive's context that compute their results only once for whatever these are of.

Results are shared, so callers must not change them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar

from rulec.extraction.drive_context import DriveContext

Found = TypeVar("Found")
Asked = ParamSpec("Asked")


class Once(Protocol):
    """Makes a function compute its result once for each choice of its further arguments."""

    def __call__(
        self, compute: Callable[Concatenate[DriveContext, Asked], Found]
    ) -> Callable[Concatenate[DriveContext, Asked], Found]:
        """The function that does so."""


def _once(kept_by: Callable[[DriveContext], dict[Any, Any]], *, along_road: bool = False) -> Once:
    """Results are kept in a dictionary of the context's, with ``along_road`` one for each road."""

    def once_for(
        compute: Callable[Concatenate[DriveContext, Asked], Found],
    ) -> Callable[Concatenate[DriveContext, Asked], Found]:
        @wraps(compute)
        def found(context: DriveContext, /, *asked: Asked.args, **named: Asked.kwargs) -> Found:
            known, of = kept_by(context), context.road if along_road else None
            key = compute, of, asked
            if key not in known:
                known[key] = compute(context, *asked, **named)
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
