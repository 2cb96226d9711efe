"""Checks of literals: the characters of texts, and dates."""

from __future__ import annotations

import re
import unicodedata
from calendar import monthrange

_ISO_DATE = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}")

_DAY_FIRST = re.compile(r"([0-9]{1,2})\. ?([0-9]{1,2})\. ?([0-9]{4})\b")

_OTHER_DASHES = re.compile(r"([0-9]{4})[-‐-―−]([0-9]{2})[-‐-―−]([0-9]{2})\b")
"""A date with the hyphens and dashes of word processors, which look like `-`."""

_BY_THE_CLOCK = re.compile(r"([0-9]{1,2})\s*[hH:.]\s*([0-5][0-9])(?:\s*h)?")

_DIRECTION_CONTROLS = frozenset("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Unicode's bidirectional controls, which display a text in another order than it is read."""


def why_not_a_day(text: str) -> str:
    """Why a text is not a day of the Gregorian calendar in ISO 8601's form; empty if it is."""
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
    """Help for a text that is not a date in ISO 8601's form.

    It gives the date in that form, if the text is a date.
    """
    if match := _OTHER_DASHES.match(text):
        written = "-".join(match.groups())
        return f"its dash is another character: write `{written}` with the `-` of the keyboard"
    if match := _DAY_FIRST.match(text):
        day, month, year = (int(part) for part in match.groups())
        written = f"{year:04}-{month:02}-{day:02}"
        if not why_not_a_day(written):
            return f"a date is written year-month-day: `{written}`"
    return "a date is written year-month-day, such as `2006-03-28`"


def how_hours_are_written(text: str) -> str:
    """Help for ``8:30`` or ``8h30``, a time of day; empty for anything else."""
    match = _BY_THE_CLOCK.fullmatch(text)
    if match is None:
        return ""
    hours, minutes = map(int, match.groups())
    exact = minutes % 3 == 0
    number = f"{hours + minutes / 60:g} h" if exact else f"{hours} h + {minutes} min"
    return f"a time of day is a number of hours: write `{number}`"


def misleads(character: str) -> bool:
    """Whether a character could mislead the reader of its line.

    Such characters are control characters, and those that break or reorder the line.
    """
    category = unicodedata.category(character)
    return character in _DIRECTION_CONTROLS or (
        character != "\t" and category in ("Cc", "Cs", "Zl", "Zp")
    )
