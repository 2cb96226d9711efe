"""Messages about texts, dates and numbers."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic, Fix, Span
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import left_out, offering
from rulec.syntax.messages.literals import last_day_of

UNKNOWN_ESCAPE = Code("R0106")

CONTROL_CHARACTER = Code("R0107")

NO_SUCH_DATE = Code("R0110")

NUMBER_TOO_LARGE = Code("R0112")


def unknown_escape(place: Span, escaped: str) -> Diagnostic:
    return UNKNOWN_ESCAPE.at(
        place,
        f"`\\{escaped}` means nothing in a text",
        help='`\\"` is a quote and `\\\\` a backslash',
        # Only the backslash is there already; that a quote is meant, no other sign says.
        fix=Fix(place.place, f"\\\\{escaped}"),
    )


def control_character(place: Span) -> Diagnostic:
    return CONTROL_CHARACTER.at(
        place,
        "a text may not hold this invisible character",
        help=offering("delete it, or type it as words", left_out(place)),
    )


def no_such_date(place: Span, date: str, reason: str) -> Diagnostic:
    return NO_SUCH_DATE.at(place, f"`{date}` is no date", help=offering(reason, *last_day_of(date)))


def number_too_large(place: Span) -> Diagnostic:
    return NUMBER_TOO_LARGE.at(place, "this number is too large", help="write a number below 1e308")
