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


def last_day_of(date: str) -> tuple[str, ...]:
    """The last day of the month of a date whose day is too late."""
    year, month, day = (
        (int(part) for part in date.split("-")) if _ISO_DATE.fullmatch(date) else (0, 0, 0)
    )
    if year < 1 or not 1 <= month <= 12 or day <= monthrange(year, month)[1]:
        return ()
    return (f"{date[:-2]}{monthrange(year, month)[1]}",)


def how_a_date_is_written(text: str) -> str:
    """Help for a text that is not a date in ISO 8601's form.

    It gives the date in that form, if the text is a date.
    """
    _, written = meant_date(text)
    if written and _OTHER_DASHES.match(text):
        return f"its dash is another character: write `{written}` with the `-` of the keyboard"
    if written:
        return f"a date is written year-month-day: `{written}`"
    return "a date is written year-month-day, such as `2006-03-28`"


def meant_date(text: str) -> tuple[str, str]:
    """A date in another form that a text begins with, and the same in ISO 8601's; else empty."""
    if match := _OTHER_DASHES.match(text):
        return match[0], "-".join(match.groups())
    if match := _DAY_FIRST.match(text):
        day, month, year = (int(part) for part in match.groups())
        written = f"{year:04}-{month:02}-{day:02}"
        if not why_not_a_day(written):
            return match[0], written
    return "", ""


def how_hours_are_written(text: str) -> str:
    """Help for ``8:30`` or ``8h30``, a time of day; empty for anything else."""
    number = _hours(text)
    return f"a time of day is a number of hours: write `{number}`" if number else ""


def hours_meant(text: str) -> tuple[str, ...]:
    """The same as one number of hours, if it is one."""
    number = _hours(text)
    return () if "+" in number or not number else (number,)


def _hours(text: str) -> str:
    match = _BY_THE_CLOCK.fullmatch(text)
    if match is None:
        return ""
    hours, minutes = map(int, match.groups())
    is_exact = minutes % 3 == 0
    return f"{hours + minutes / 60:g} h" if is_exact else f"{hours} h + {minutes} min"


def misleads(character: str) -> bool:
    """Whether a character could mislead the reader of its line.

    Such characters are control characters, and those that break or reorder the line.
    """
    category = unicodedata.category(character)
    return character in _DIRECTION_CONTROLS or (
        character != "\t" and category in ("Cc", "Cs", "Zl", "Zp")
    )
