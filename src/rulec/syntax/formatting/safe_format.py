"""Formatting that cannot change the meaning of a file."""

from __future__ import annotations

from collections import Counter

from rulec.diagnostics import RulecError, Source
from rulec.syntax.formatting.comments import comments_of
from rulec.syntax.formatting.file_layout import arranged
from rulec.syntax.parser import parse
from rulec.syntax.scanner import decode, scan


class FormattingError(Exception):
    """A bug in the formatter: its output would mean something else than the file."""


def format_source(source: Source) -> str:
    """The text of a rulebook or a vocabulary in its canonical form.

    It reads as the same tree, has the same words, signs and comments, and is its own canonical
    form: all of this is checked whenever it is another text.

    Raises:
        RulecError: with all mistakes of spelling in the file; it has no such form then.
        FormattingError: a check has failed, which is a mistake in rulec.
    """
    tree, mistakes = parse(source)
    if any(mistake.severity == "error" for mistake in mistakes):
        raise RulecError(mistakes)
    text = arranged(source)
    if text == source.text:
        return text  # it is the file itself
    made = Source(source.name, text)
    again, of_it = parse(made)
    if len(of_it) != len(mistakes) or again != tree:
        raise FormattingError(f"formatting would change what {source.name} means")
    if _signs(made) != _signs(source):
        raise FormattingError(f"formatting would change words or signs of {source.name}")
    if _comments(made) != _comments(source):
        raise FormattingError(f"formatting would change comments of {source.name}")
    if arranged(made) != text:
        raise FormattingError(f"formatting {source.name} twice is not the same as once")
    return text


def format_bytes(name: str, data: bytes) -> bytes:
    """The same for a file's content. Raises RulecError as ``decode`` does, too."""
    return format_source(decode(name, data)).encode()


def _signs(source: Source) -> str:
    return "".join(token.text for token in scan(source) if token.text not in ("(", ")"))


def _comments(source: Source) -> Counter[str]:
    return Counter(comment.text for comment in comments_of(source, scan(source)))
