"""Help with names and numbers in scripts other than Latin."""

from __future__ import annotations

import unicodedata
from typing import Final

from rulec.diagnostics import Source, Span
from rulec.diagnostics.ways_out import Help, offering, write
from rulec.syntax.messages.parse_context import ParseContext
from rulec.syntax.scanner import Token

_MOST: Final = 60
"""The most characters of a name or a number that are looked at."""


def advise_on_script(ctx: ParseContext) -> Help:
    """Advice on a mark that belongs to a letter, or on other digits; empty if there is none."""
    token = ctx.unexpected
    if token is None or len(token.text) != 1 or token.text.isascii():
        return ""
    if not token.text.isdecimal():
        return advise_on_mark(ctx.source, token)
    number = _run(ctx.source, token.start)
    written = "".join(
        str(unicodedata.decimal(sign)) if sign.isdecimal() else sign for sign in number.text
    )
    return offering(f"digits are those from `0` to `9`: write `{written}`", write(written, number))


def advise_on_mark(source: Source, token: Token) -> str:
    """Advice on a mark of a letter, such as a vowel sign, in a name; empty for anything else."""
    if not _is_mark(token.text):
        return ""
    start = token.start
    while start and token.start - start < _MOST and _in_a_name(source.text[start - 1]):
        start -= 1
    return (
        f"a name consists of letters, digits and `_`, and `{token.text}` is a mark that is added "
        f"to a letter: write `{_run(source, start).text}` without marks, such as in Latin letters"
    )


def _run(source: Source, start: int) -> Span:
    """The characters of a name or a number from a place on."""
    text, end = source.text, start
    while end < len(text) and end - start < _MOST and _in_a_name(text[end]):
        end += 1
    return Span(source, start, end)


def _in_a_name(character: str) -> bool:
    return character == "_" or character.isalnum() or _is_mark(character)


def _is_mark(text: str) -> bool:
    return len(text) == 1 and unicodedata.category(text) in ("Mn", "Mc", "Me")
