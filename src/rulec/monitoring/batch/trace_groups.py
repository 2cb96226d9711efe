"""Traces that differ only in their values and their objects' names."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from rulec.monitoring.verdict import Violation
from rulec.trace import Trace

Names: TypeAlias = tuple[str, ...]
"""The objects of a trace, in their order."""


def shape_of(trace: Trace) -> tuple[object, ...]:
    """The shape of a trace: step, object types in order, and presence, without names."""
    places = {name: place for place, name in enumerate(trace.objects)}
    stretches = [(places[name], stretch) for name, stretch in trace.present.items()]
    return trace.step_s, tuple(trace.objects.values()), tuple(sorted(stretches))


def under_own_names(
    violations: Sequence[Violation], objects: Names, own: Names
) -> tuple[Violation, ...]:
    """Violations with the group's object names replaced by a trace's own."""
    if not violations or objects == own:
        return tuple(violations)
    names = dict(zip(objects, own, strict=True))
    return tuple(
        [
            Violation(
                violation.rule,
                violation.strength,
                {variable: names[item] for variable, item in violation.binding.items()},
                violation.step,
            )
            for violation in violations
        ]
    )
