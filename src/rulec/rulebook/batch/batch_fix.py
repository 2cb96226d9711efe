"""Applies the fixes of findings to the sources in which they were found."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from rulec.diagnostics import Diagnostic, Fix, RulecError, Source
from rulec.rulebook.batch.batch_format import Formatted, replace_files
from rulec.rulebook.files.search_path import read_bytes
from rulec.syntax import decode


def write_fixes(files: Iterable[str], findings: Sequence[Diagnostic]) -> tuple[int, list[str]]:
    """Write the fixes of findings into the requested files.

    Of overlapping fixes one is written; the others will be found again. Returns the number of fixes
    and the paths of the files. Raises RulecError.
    """
    wanted = [finding.fix for finding in findings if finding.fix is not None]
    done: list[Formatted] = []
    number = 0
    for file in files:
        fixes = [fix for fix in wanted if fix.place.file == file]
        if fixes:
            data = read_bytes(Path(file))
            text, written = fixed(decode(file, data), fixes)
            number += written
            done.append(Formatted(file, Path(file), data, text.encode()))
    refused = replace_files(done)
    if refused:
        raise RulecError(refused)
    return number, [file.name for file in done]


def fixed(source: Source, fixes: Iterable[Fix]) -> tuple[str, int]:
    """The text of a source with non-overlapping fixes applied, and their number."""
    parts: list[str] = []
    at = number = 0
    for fix in sorted(fixes, key=lambda fix: fix.place.start):
        start = source.offset(fix.place.line or 1, fix.place.column or 1)
        end = source.offset(fix.place.end_line or 1, fix.place.end_column or 1)
        if start >= at:
            parts += (source.text[at:start], fix.text)
            at, number = end, number + 1
    return "".join((*parts, source.text[at:])), number
