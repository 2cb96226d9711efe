"""Messages about files and settings."""

from __future__ import annotations

import codecs
import errno
import os
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError, Source, SourceLocation
from rulec.diagnostics.code import Code

NOT_UTF8 = Code("R0101")

FILE_TOO_LARGE = Code("R0102")

TOO_LONG_TO_READ = Code("R0736")

UNREADABLE_FILE = Code("R0701")

UNWRITABLE_FILE = Code("R0702")

WRONG_SETTINGS = Code("R0704")

NO_OUTPUT = Code("R0720")

NO_INPUT = Code("R0721")

NO_WORKING_FOLDER = Code("R0722")

REFUSED_BY_SYSTEM = Code("R0723")

LINK_OUT = Code("R0730")

NO_ORDINARY_FILE = Code("R0731")

OUT_OF_TREE = Code("R0732")

NOTHING_LEFT = Code("R0733")

NOT_THE_SAME_FILE = Code("R0734")

OVERWRITES_INPUT = Code("R0735")


def not_the_same(path: Path, why: str) -> RulecError:
    return NOT_THE_SAME_FILE.error(
        SourceLocation(str(path)),
        f"the file is not rewritten: {why}",
        help="write a copy of it, or use `rulec fmt - < FILE > OTHER`",
    )


_DOCUMENTS = {
    b"PK\x03\x04": "an office document or another archive",
    b"\xd0\xcf\x11\xe0": "an office document",
    b"%PDF": "a PDF",
}
"""First bytes of files that are mistaken for text files."""


def not_utf8(name: str, data: bytes, position: int) -> Diagnostic:
    way_out = "save the file as UTF-8"
    document = next((words for mark, words in _DOCUMENTS.items() if data.startswith(mark)), "")
    if document:
        place = SourceLocation(name, 1, 1, 1, 1)
        return NOT_UTF8.at(
            place, f"the file is {document}, not plain text", help="save it as plain text, in UTF-8"
        )
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        place = SourceLocation(name, 1, 1, 1, 1)
        return NOT_UTF8.at(place, "the file is in UTF-16, not in UTF-8", help=way_out)
    before = Source(name, data[:position].decode("utf-8"))
    line, column = before.position(len(before.text))
    excerpt = data.split(b"\n")[line - 1].decode("utf-8", "replace").rstrip("\r\0")
    return NOT_UTF8.at(
        SourceLocation(
            file=name,
            line=line,
            column=column,
            end_line=line,
            end_column=column + 1,
            excerpt=excerpt,
        ),
        f"the byte 0x{data[position]:02x} is not UTF-8",
        help=way_out,
    )


def reason_in_words(problem: OSError | ValueError) -> str:
    if isinstance(problem, IsADirectoryError):
        return "it is a folder"
    if isinstance(problem, FileExistsError):
        return "a file of this name is there, where a folder is wanted"
    if isinstance(problem, NotADirectoryError):
        return "a part of its path before a `/` is a file, not a folder"
    known = problem.strerror if isinstance(problem, OSError) else None
    return (known or str(problem)).lower()


def unwritable(path: Path, problem: OSError) -> Diagnostic:
    way_out = ""
    if isinstance(problem, FileNotFoundError) and not path.parent.exists():
        way_out = f"make the folder `{path.parent}` first, or give a file in another one"
    if isinstance(problem, PermissionError):
        way_out = "change its permissions, or give a file in a folder that you may write to"
    if isinstance(problem, FileExistsError | NotADirectoryError):
        way_out = "move that file away, or name another folder"
    if problem.errno == errno.ENOSPC:
        way_out = "make room there, or give a file on another disk"
    if problem.errno == errno.EROFS:
        way_out = "give a file in a folder that may be written to"
    return UNWRITABLE_FILE.at(
        SourceLocation(str(path)),
        f"the file cannot be written: {reason_in_words(problem)}",
        help=way_out,
    )


def no_input(problem: OSError) -> RulecError:
    """The error for standard input that cannot be read."""
    return NO_INPUT.error(
        SourceLocation("standard input"),
        f"standard input cannot be read: {reason_in_words(problem)}",
        help="give a file, or the output of a program",
    )


def no_temporary_files(folder: str, problem: OSError) -> RulecError:
    """The error (R0723) about the folder for temporary files."""
    return REFUSED_BY_SYSTEM.error(
        SourceLocation(folder),
        f"temporary files cannot be written to this folder: {reason_in_words(problem)}",
        help="free space in it, or name another folder in the environment variable `TMPDIR`",
    )


def refused(problem: OSError, *, is_gone: bool) -> Diagnostic:
    """The message for an operating system error that has no message of its own.

    An error with a file name in it is about that file or program; otherwise it is about the working
    folder if that ``is_gone``, else about standard output, since all else names its file.
    """
    why = reason_in_words(problem)
    if problem.filename is not None:
        name = os.fsdecode(problem.filename) if not isinstance(problem.filename, int) else "a file"
        help_text = "free the missing resource, and try again"
        return REFUSED_BY_SYSTEM.at(
            SourceLocation(name), f"it cannot be opened or started: {why}", help=help_text
        )
    if is_gone:
        return NO_WORKING_FOLDER.at(
            SourceLocation("."),
            "the working folder no longer exists",
            help="change to a folder that exists",
        )
    return NO_OUTPUT.at(
        SourceLocation("standard output"),
        f"standard output cannot be written to: {why}",
        help="write to a file elsewhere, with `> FILE`, or `-o FILE` if the command has it",
    )
