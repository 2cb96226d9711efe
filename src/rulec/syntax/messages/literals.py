"""Literals: characters that a text may hold, dates that exist."""

from __future__ import annotations

import re
import unicodedata
from calendar import monthrange

_ISO_DATE = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}")

_DAY_FIRST = re.compile(r"([0-9]{1,2})\. ?([0-9]{1,2})\. ?([0-9]{4})\b")

_BY_THE_CLOCK = re.compile(r"([0-9]{1,2})\s*[hH:.]\s*([0-5][0-9])(?:\s*h)?")

_DIRECTION_CONTROLS = frozenset("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Unicode's bidirectional controls: they show a text in another order than it is read."""


def why_not_a_day(text: str) -> str:
    """Empty for a day of the Gregorian calendar in ISO 8601's form."""
    if not _ISO_DATE.fullmatch(text):
        return how_a_date_is_written(text)
    year, month, day = (int(part) for part in text.split("-"))
    if year < 1:
        return "years begin with 0001"
    if not 1 <= month <= 12:
        return "months go from 01 to 12"
    days = monthrange(year, month)[1]
    return "" if 1 <= day <= days else f"that month has {days} days"


def how_a_date_is_written(text: str) -> str:
    """The way out for what is no date in ISO 8601's form: in that form, where it is one."""
    if match := _DAY_FIRST.match(text):
        day, month, year = (int(part) for part in match.groups())
        written = f"{year:04}-{month:02}-{day:02}"
        if not why_not_a_day(written):
            return f"a date is written year-month-day: `{written}`"
    return "a date is written year-month-day, such as `2006-03-28`"


def how_hours_are_written(text: str) -> str:
    """The way out for ``8:30`` or ``8h30``, a time of day by the clock; empty for anything else."""
    match = _BY_THE_CLOCK.fullmatch(text)
    if match is None:
        return ""
    hours, minutes = map(int, match.groups())
    exact = minutes % 3 == 0
    number = f"{hours + minutes / 60:g} h" if exact else f"{hours} h + {minutes} min"
    return f"a time of day is a number of hours: write `{number}`"


def misleads(character: str) -> bool:
    """Tell whether a character could mislead the reader of its line.

    It is a control character, or breaks or reorders the line.
    """
    category = unicodedata.category(character)
    return character in _DIRECTION_CONTROLS or (
        character != "\t" and category in ("Cc", "Cs", "Zl", "Zp")
    )
