"""Names whose numbers are known only within bounds that contain a limit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from rulec.monitoring.verdict import OpenReasons, Reason
from rulec.trace import State
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval


def told_within_bounds(reasons: OpenReasons, is_within: Callable[[str], bool]) -> OpenReasons:
    """The reasons, separated into names that are not told and names told within bounds."""
    if "not told" not in reasons.because:
        return reasons
    within = [name for name in reasons.depends_on if is_within(name)]
    if not within:
        return reasons
    first: tuple[Reason, ...] = ("tolerance",)
    if len(within) < len(reasons.depends_on):
        first = ("not told", *first)
    others = [reason for reason in reasons.because if reason != "not told"]
    return reasons._replace(because=(*first, *others))


def is_within_bounds(name: str, states: Sequence[State], vocabulary: Vocabulary) -> bool:
    """Whether some number is an interval, and none is entirely unknown."""
    default = vocabulary.declarations[name].default
    values = [value for state in states for value in _leaves(state.get(name, default))]
    return UNKNOWN not in values and any(isinstance(value, Interval) for value in values)


def _leaves(value: Any) -> Iterator[Any]:
    if isinstance(value, Mapping):
        for inner in value.values():
            yield from _leaves(inner)
    else:
        yield value
