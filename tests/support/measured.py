"""Measured numbers without their tolerances, to be held against what was drawn."""

from collections.abc import Mapping

from rulec.vocabulary.partial_values import Interval


def middle(value):
    """The middle of an interval, in maps and lists, too; other values as they are."""
    if isinstance(value, Mapping):
        return {name: middle(inner) for name, inner in value.items()}
    if isinstance(value, list | tuple):
        return type(value)(map(middle, value))
    return value.middle if isinstance(value, Interval) else value
