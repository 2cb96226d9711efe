"""Messages about texts, dates and numbers."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic, Fix, Span
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import left_out, offering
from rulec.syntax.messages.literals import last_day_of

UNKNOWN_ESCAPE = Code(
    "R0106",
    title="a text contains an unknown escape",
    why='In a text, a backslash can only be followed by a quote (`\\"`) or a backslash (`\\\\`).',
    bad='rulebook example\ntitle "either\\or"\nsignal p\nhard rule r { require always p }\n',
    good='rulebook example\ntitle "either\\\\or"\nsignal p\nhard rule r { require always p }\n',
)

CONTROL_CHARACTER = Code(
    "R0107",
    title="a text contains a control character",
    why="Texts are shown in terminals and reports. Characters that control a terminal, or reverse "
    "the direction of the text, could make one rule look like another.",
    bad='printf \'rulebook a title "⟪\\033[2J|clear⟫" signal p hard rule r { require '
    "always p }' | rulec check -",
    kind="command",
)

NO_SUCH_DATE = Code(
    "R0110",
    title="a date is not in the calendar",
    why="A date is written `year-month-day` and must exist. Dates follow `as of` and `in force`.",
    bad='rulebook example\nlaw "A law" as of ⟪2023|2024⟫-02-29\nsignal p\n'
    "hard rule r { require always p }\n",
)

NUMBER_TOO_LARGE = Code(
    "R0112",
    title="a number is too large or too long",
    why="Numbers may be as large as about 1.8e308, as in most programs, and have at most 400 "
    "digits.",
    bad="rulebook example\nquantity speed in km/h default ⟪1e999|130⟫\nsignal p\n"
    "hard rule r { require always p }\n",
)


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
