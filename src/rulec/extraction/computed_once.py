"""Functions that compute their result only once for each choice of arguments, and who keeps it.

Results are shared, so callers must not change them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, wraps
from operator import attrgetter
from typing import Any, ParamSpec, TypeVar

Asked = ParamSpec("Asked")
Found = TypeVar("Found")


def kept_in(name: str) -> Callable[[Callable[Asked, Found]], Callable[Asked, Found]]:
    """For functions whose results a dictionary of the first argument, an attribute, keeps.

    The other arguments are hashable, and given by their places.
    """
    results = attrgetter(name)

    def keeping(compute: Callable[Asked, Found]) -> Callable[Asked, Found]:
        @wraps(compute)
        def found(*asked: Asked.args, **named: Asked.kwargs) -> Found:
            # By its public name, as which another process finds it when results are sent.
            known, key = results(asked[0]), (found, *asked[1:])
            if key not in known:
                known[key] = compute(*asked, **named)
            value: Found = known[key]
            return value

        return found

    return keeping


class KeepsResults:
    """An object that keeps results of its methods."""

    @cached_property
    def computed(self) -> dict[Any, Any]:
        """The results, by method and arguments."""
        return {}


kept = kept_in("computed")
"""For a method of ``KeepsResults``."""

once = kept
"""For a function of a drive's context."""

once_a_recording = kept_in("surroundings.computed")
"""For one of only the recording and its thresholds.

The recording's surroundings keep the result; they belong to one side of traffic and one choice of
thresholds.
"""

once_a_map = kept_in("surroundings.of_map")
"""For one of only the recording's map."""

once_a_road = kept_in("road.computed")
"""For one of only the map and one road."""
