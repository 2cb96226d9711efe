"""Numbers of maneuvers, which may have any size."""

from __future__ import annotations

MOST_DIGITS = 30


def shown_count(count: int) -> str:
    """A count for people: exact if short, else its magnitude."""
    digits = str(count)
    if len(digits) <= MOST_DIGITS:
        return f"{count:,}"
    return f"about {digits[0]}.{digits[1:3]}e{len(digits) - 1}"
