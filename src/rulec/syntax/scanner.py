"""Decodes bytes, and scans a text coarsely, without ever failing, to find its pieces.

It recognises strings, comments and line starts; the grammar decides what the tokens mean.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

from rulec.cancellation import step
from rulec.diagnostics import Diagnostic, RulecError, Source, SourceLocation, Span
from rulec.diagnostics.diagnostic import unquoted
from rulec.files.file_messages import FILE_TOO_LARGE
from rulec.files.read_files import MAX_SOURCE_BYTES, decoded, without_null
from rulec.files.source_detection import beginning_of, is_foreign

MAX_TOKENS = 1_000_000
"""The most tokens: far more than a file of the permitted size has, and still fit for memory."""

# A text that runs on is taken for one if a quote ends the line that it ends on.
_TOKEN = re.compile(
    r"""
      (?P<skip>\s+|\#[^\n]*)
    | (?P<string>"(?:[^"\\\r\n]|\\[^\r\n])*")
    | (?P<run_on>"[^"\r\n]*(?:\r?\n[^"\r\n]*){1,20}"(?=[ \t]*(?:\#[^\n]*)?(?:\r?\n|\Z)))
    | (?P<unterminated>"[^\r\n]*)
    | (?P<quoted>'[^'\r\n]*')
    | (?P<word>[^\W\d]\w*)
    | (?P<number>[0-9]+-[0-9]+(?:-\w+)*|[0-9]\w*(?:\.\w+)*)
    | (?P<symbol>//|/\*|\*\*|<->|<=>|==>|===|-->|->|=>|=<|==|!==|!=|:=|<=|>==|>=|&&|\|\||\[\]|<>
                 |\.\.\.|\.\.|.)
    """,
    re.VERBOSE,
)


def decode(name: str, data: bytes) -> Source:
    """The text of a rulebook file; a byte order mark is dropped.

    Raises RulecError if it has more than ``MAX_SOURCE_BYTES``, is not UTF-8, or is not a text at
    all.
    """
    _check_size(name, len(data))
    try:
        return decoded(name, data)
    except RulecError as error:
        if not is_foreign(beginning_of(data)):
            raise
        # Not a word of a file that is another program's, or a secret behind a link.
        raise RulecError(tuple(map(unquoted, error.diagnostics))) from None


def checked(source: Source) -> Source:
    """The source, if it can be the text of a rulebook.

    Raises RulecError if it is too large or contains a null character.
    """
    _check_size(source.name, len(source.text))
    return without_null(source)


def _check_size(name: str, size: int) -> None:
    if size > MAX_SOURCE_BYTES:
        raise FILE_TOO_LARGE.error(
            SourceLocation(name),
            f"the file is too large: at most {MAX_SOURCE_BYTES:,} bytes are read",
            help="split it into several rulebooks",
        )


class Token(NamedTuple):
    """Characters ``start`` to ``end``; ``first`` marks the first token of a line."""

    kind: str
    text: str
    start: int
    end: int
    first: bool


def scan(source: Source) -> list[Token]:
    """All tokens of a text. Raises RulecError if it has more than ``MAX_TOKENS``."""
    tokens = [*islice(tokens_of(source), MAX_TOKENS + 1)]
    if len(tokens) > MAX_TOKENS:
        raise RulecError(_too_many(source, tokens[-1].start))
    return tokens


def tokens_of(source: Source) -> Iterator[Token]:
    """The tokens of a text one by one, without white space and comments.

    ``kind`` is one of string, unterminated, quoted (in single quotes), word, number, symbol.
    """
    text = source.text
    first = True
    position = 0
    match = _TOKEN.match
    while position < len(text):
        match_ = match(text, position)
        assert match_ is not None, "the last alternative takes any character"
        kind, end = match_.lastgroup or "", match_.end()
        if kind == "skip":
            if "\n" in match_.group():
                step()
                first = True
        else:
            if kind == "run_on":
                kind = "unterminated"
            elif kind == "unterminated":
                end = _end_of_unterminated(text, position, end)
            yield Token(kind, text[position:end], position, end, first)
            first = False
        position = end


def _end_of_unterminated(text: str, start: int, end: int) -> int:
    """The end of an unterminated text, before a brace that closes an outer block.

    The brace is left to the rest of the file, so that one missing quote causes one error.
    """
    line = text[start:end]
    surplus = line.count("{") - line.count("}")
    if surplus > 0:
        return start + line.rindex("{")
    if surplus < 0:
        return start + line.rindex("}")
    return start + len(line.rstrip())


def _too_many(source: Source, position: int) -> Diagnostic:
    return FILE_TOO_LARGE.at(
        Span(source, position, position + 1),
        f"the file holds more than {MAX_TOKENS:,} words and signs",
        help="split it into several rulebooks",
    )
