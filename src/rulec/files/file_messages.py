"""Messages about files and settings."""

from __future__ import annotations

import codecs
import errno
import os
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError, Source, SourceLocation
from rulec.diagnostics.code import Code

NOT_UTF8 = Code(
    "R0101",
    title="a file is not a text in UTF-8",
    why="Files are plain text in UTF-8, so that names and sentences in any language read the same "
    "everywhere. Save the file as UTF-8; a file from a word processor is not a plain text.",
    bad=r"printf 'rulebook stra\337e signal p hard rule r { require always p }' | rulec check -",
    good=r"printf 'rulebook stra\303\237e signal p "
    "hard rule r { require always p }' | rulec check -",
    kind="command",
)

FILE_TOO_LARGE = Code(
    "R0102",
    title="a file is too large",
    why="A rulebook or a vocabulary may have 5,000,000 bytes, more than any law needs. If a "
    "program wrote the file, split it into several rulebooks.",
    bad="{ echo 'rulebook a signal p hard rule r { require always p }'\n"
    "  head -c 5000000 /dev/zero | tr '\\0' '#'; } | rulec check -",
    good="{ echo 'rulebook a signal p hard rule r { require always p }'\n"
    "  head -c 50000 /dev/zero | tr '\\0' '#'; } | rulec check -",
    kind="command",
)

TOO_LONG_TO_READ = Code(
    "R0736",
    title="a file is too long for its kind",
    why="Texts of laws, saved audits and monitors, compiled rulebooks and settings are read "
    "completely, so their size is limited, for compressed files after decompression, since a "
    "small file may expand to gigabytes.",
    bad="head -c 6000000 /dev/zero | gzip > law.md.gz\nrulec audit vienna --law law.md.gz",
    good="printf '### Article 1 Scope\\nText.\\n' > law.md\nrulec audit vienna --law law.md",
    kind="command",
)

UNREADABLE_FILE = Code(
    "R0701",
    title="a file cannot be read",
    why="The file does not exist, is a folder, may not be read, or is a damaged gzip file; the "
    "message says which.",
    bad="rulec check ./no_such.rules",
    good="echo 'rulebook a signal p hard rule r { require always p }' > such.rules\n"
    "rulec check ./such.rules",
    kind="command",
)

UNWRITABLE_FILE = Code(
    "R0702",
    title="a file cannot be written",
    why="The folder does not exist and cannot be created, the name is taken by something else, "
    "the file may not be written, or the disk is full. No half-written file remains.",
    bad="echo notes > build\nrulec compile esterle2019 -o build",
    good="echo notes > notes\nrulec compile esterle2019 -o build",
    kind="command",
)

WRONG_SETTINGS = Code(
    "R0704",
    title="a project's settings are wrong",
    why="The nearest `rulec.toml`, in the working folder or above it, is not TOML, has an unknown "
    "setting, or lists in `search_path` something that is not a folder.",
    bad="echo 'search_path = [\"no_such\"]' > rulec.toml\nrulec compile esterle2019 -o out",
    good="mkdir books\necho 'search_path = [\"books\"]' > rulec.toml\n"
    "rulec compile esterle2019 -o out",
    kind="command",
)

NO_OUTPUT = Code(
    "R0720",
    title="standard output cannot be written to",
    why="The disk of the output file is full, or its device does not accept data, so the answer "
    "is incomplete. A reader that stops early, such as `head`, is not an error.",
    bad="rulec list > /dev/full",
    good="rulec list > /dev/null",
    kind="command",
)

NO_INPUT = Code(
    "R0721",
    title="standard input cannot be read",
    why="Reading from its device fails, or it is open only for writing. `-` stands for standard "
    "input.",
    bad="rulec check - 0> written",
    good="echo 'rulebook a signal p hard rule r { require always p }' | rulec check -",
    kind="command",
)

NO_WORKING_FOLDER = Code(
    "R0722",
    title="the working folder no longer exists",
    why="The folder in which the command was started has been removed, so relative paths lead "
    "nowhere. Change to an existing folder.",
    bad="mkdir gone\ncd gone\nrmdir ../gone\nrulec list",
    good="mkdir there\ncd there\nrulec list",
    kind="command",
)

REFUSED_BY_SYSTEM = Code(
    "R0723",
    title="the system lacks a resource that rulec needs",
    why="No further process can be started, no further file opened, or there is no room for "
    "temporary files (in the folder named by TMPDIR); the message says for which file or program "
    "and why. The input is not at fault.",
    kind="circumstance",
)

LINK_OUT = Code(
    "R0730",
    title="a link leads out of its tree",
    why="A file in somebody else's checkout may be a link to any file on this machine, so rulec "
    "does not read or write through links that lead out of the tree, which is the git work tree "
    "or, without one, the named folder. If you do mean that file, give its own path.",
    bad="mkdir books\necho 'rulebook a signal p hard rule r { require always p }' > a.rules\n"
    "ln -s ../a.rules books/a.rules\nrulec check books",
    good="mkdir books\necho 'rulebook a signal p hard rule r { require always p }' > a.rules\n"
    "ln -s ../a.rules books/a.rules\nrulec check a.rules",
    kind="command",
)

NO_ORDINARY_FILE = Code(
    "R0731",
    title="something is not an ordinary file",
    why="A pipe, a socket or a device has the name of a source. Reading it might never end, so it "
    "is skipped. Standard input is called `-`.",
    bad="mkfifo pipe.rules\nrulec check .",
    good="mkfifo pipe\necho 'rulebook a signal p hard rule r { require always p }' > pipe &\n"
    "rulec check - < pipe",
    kind="command",
)

OUT_OF_TREE = Code(
    "R0732",
    title="a setting names a folder outside of its tree",
    why="A `rulec.toml` may come from somebody else's checkout, so the folders in its "
    "`search_path` must have relative names and be in the same git work tree or, without one, "
    "below the file itself.",
    bad="echo 'search_path = [\"/tmp\"]' > rulec.toml\nrulec list",
    good="mkdir books\necho 'search_path = [\"books\"]' > rulec.toml\nrulec list",
    kind="command",
)

NOTHING_LEFT = Code(
    "R0733",
    title="a folder contains no source",
    why="No file in the folder, at any depth, is called `….rules` and begins with `rulebook` or "
    "`vocabulary` (apart from comments); or all of them are skipped, because git ignores them or "
    "they are in an environment such as `venv`. A file that is named explicitly is never skipped.",
    bad="echo 'package x; rule y' > other.rules\nrulec check .",
    good="echo 'package x; rule y' > other.rules\n"
    "echo 'rulebook a signal p hard rule r { require always p }' > mine.rules\nrulec check .",
    kind="command",
)

NOT_THE_SAME_FILE = Code(
    "R0734",
    title="rewriting a file would change its links or owner",
    why="When `rulec fmt` changes a file it replaces it by a new one, so that it is never half "
    "written. A file with several names (hard links) would then become two files, and a file of "
    "another owner might become yours. Such files are not changed.",
    bad="echo 'rulebook a  signal p hard rule r { require always p }' > a.rules\n"
    "ln a.rules b.rules\nrulec fmt a.rules",
    good="echo 'rulebook a  signal p hard rule r { require always p }' > a.rules\n"
    "cp a.rules b.rules\nrulec fmt a.rules",
    kind="command",
)

OVERWRITES_INPUT = Code(
    "R0735",
    title="the output would overwrite an input",
    why="The output file is one that the command reads, possibly by another path or a link, or an "
    "existing source. Nothing was read or written. Choose another output file.",
    bad="echo 'rulebook a signal p hard rule r { require always p }' > a.rules\n"
    "rulec doc ./a.rules -o a.rules --output-format markdown",
    good="echo 'rulebook a signal p hard rule r { require always p }' > a.rules\n"
    "rulec doc ./a.rules -o a.md",
    kind="command",
)


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
