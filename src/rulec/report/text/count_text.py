"""Numbers of maneuvers, which may have any size, and the first of many names."""

from __future__ import annotations

from collections.abc import Sequence

MOST_DIGITS = 30


def shown_count(count: int) -> str:
    """A count for people: exact if short, else its magnitude."""
    digits = str(count)
    if len(digits) <= MOST_DIGITS:
        return f"{count:,}"
    return f"about {digits[0]}.{digits[1:3]}e{len(digits) - 1}"


def first_of(names: Sequence[str], most: int) -> str:
    """So many names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{', '.join(names[:most])}{more}"
