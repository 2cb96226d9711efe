"""Shapes of traces: all but the names of their objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rulec.monitoring.verdict import Violation
from rulec.trace import Trace

Shape = tuple[object, ...]

Names = tuple[str, ...]
"""The objects of a trace, in its order."""

_PLAIN = frozenset((bool, int, float, str))


def shape_of(trace: Trace) -> Shape:
    """Shape of a trace: step, object types in order, presence; no names."""
    places = {name: place for place, name in enumerate(trace.objects)}
    stretches = [(places[name], stretch) for name, stretch in trace.present.items()]
    return trace.step_s, tuple(trace.objects.values()), tuple(sorted(stretches))


def renamed(about: object, names: Mapping[str, str]) -> dict[str, Any] | None:
    """Values by object, with the objects renamed.

    None if they are about anything but these objects, or are unusual.
    """
    if type(about) is not dict:
        return None
    result = {}
    for item, value in about.items():
        said = value if type(value) in _PLAIN else renamed(value, names)
        if said is None or item not in names:
            return None
        result[names[item]] = said
    return result


def renamed_state(state: object, names: Mapping[str, str]) -> dict[str, Any] | None:
    """State with its objects renamed; None if that is not possible."""
    if type(state) is not dict:
        return None
    result = {
        name: value if type(value) in _PLAIN else renamed(value, names)
        for name, value in state.items()
    }
    return None if None in result.values() else result


def under_own_names(
    violations: Sequence[Violation], objects: Names, own: Names
) -> tuple[Violation, ...]:
    """Violations with the group's object names replaced by a trace's own."""
    if not violations or objects == own:
        return tuple(violations)
    names = dict(zip(objects, own, strict=True))
    return tuple([_bound_to(violation, names) for violation in violations])


def _bound_to(violation: Violation, names: Mapping[str, str]) -> Violation:
    binding = {variable: names[item] for variable, item in violation.binding.items()}
    return Violation(violation.rule, violation.strength, binding, violation.step)
