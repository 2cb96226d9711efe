"""Reading TOML files, the same on every Python version, with places of errors."""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any

from rulec.diagnostics import RulecError, Source, SourceLocation
from rulec.diagnostics.code import Code

_DEEP_KEY = re.compile(r"^[ \t\[]*\w+(?:[ \t]*\.[ \t]*\w+){40}", re.MULTILINE)


def parsed_toml(source: Source, code: Code, how: str) -> dict[str, Any]:
    """A TOML file's tables.

    Args:
        source: the file's text.
        code: the code of the diagnostic if it is not TOML.
        how: the way out in that case: how such a file is written.

    Raises RulecError: with that code, at the place of the mistake.
    """
    try:
        tomllib: Any = import_module("tomllib")
    except ModuleNotFoundError:  # Python 3.10
        tomllib = import_module("tomli")
    if _DEEP_KEY.search(source.text):
        # The parser's time grows with the square of a key's depth.
        message = "a key has too many parts joined by dots"
        raise _not_toml(message, SourceLocation(source.name), code, how)
    try:
        parsed: dict[str, Any] = tomllib.loads(source.text)
    except RecursionError:
        message, place = "brackets are nested too deeply", SourceLocation(source.name)
    except ValueError as error:
        message, place = _syntax_error(str(error), source)
    else:
        return parsed
    raise _not_toml(message, place, code, how) from None


def _not_toml(message: str, place: SourceLocation, code: Code, how: str) -> RulecError:
    return code.error(place, f"the file is not TOML: {message}", help=how)


def _syntax_error(message: str, source: Source) -> tuple[str, SourceLocation]:
    words = re.sub(r" \(at [^()]*\)$", "", message)
    words = re.sub(r":? value has \d+ digits;.*", "", words)
    at = re.search(r"\(at line (\d+), column (\d+)\)$", message)
    if at is not None:
        line, column = int(at.group(1)), int(at.group(2))
    elif message.endswith("(at end of document)"):
        line, column = source.position(len(source.text))
    else:
        return words, SourceLocation(source.name)
    return words, SourceLocation(
        file=source.name,
        line=line,
        column=column,
        end_line=line,
        end_column=column + 1,
        excerpt=source.line(line),
    )
