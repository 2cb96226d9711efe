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
    why="A rulebook or a vocabulary may have 5,000,000 bytes. No law is that long; if a program "
    "wrote the file, split it into several rulebooks.",
    bad="{ echo 'rulebook a signal p hard rule r { require always p }'\n"
    "  head -c 5000000 /dev/zero | tr '\\0' '#'; } | rulec check -",
    good="{ echo 'rulebook a signal p hard rule r { require always p }'\n"
    "  head -c 50000 /dev/zero | tr '\\0' '#'; } | rulec check -",
    kind="command",
)

TOO_LONG_TO_READ = Code(
    "R0736",
    title="a file is longer than any of its kind",
    why="Texts of laws, saved audits and monitors, compiled rulebooks and settings are read as a "
    "whole, so each kind has a limit on its bytes, those of a packed file unpacked. A small file "
    "may hide gigabytes.",
    bad="head -c 6000000 /dev/zero | gzip > law.md.gz\nrulec audit vienna --law law.md.gz",
    good="printf '### Article 1 Scope\\nText.\\n' > law.md\nrulec audit vienna --law law.md",
    kind="command",
)

UNREADABLE_FILE = Code(
    "R0701",
    title="a file cannot be read",
    why="There is no such file, it is a folder, or it may not be read, or it is "
    "packed (gzip) and damaged; the message says which.",
    bad="rulec check ./no_such.rules",
    good="echo 'rulebook a signal p hard rule r { require always p }' > such.rules\n"
    "rulec check ./such.rules",
    kind="command",
)

UNWRITABLE_FILE = Code(
    "R0702",
    title="a file cannot be written",
    why="The folder does not exist and cannot be made, something else has its name, it may not be "
    "written to, or the disk is full. Nothing is left behind half written.",
    bad="echo notes > build\nrulec compile esterle2019 -o build",
    good="echo notes > notes\nrulec compile esterle2019 -o build",
    kind="command",
)

WRONG_SETTINGS = Code(
    "R0704",
    title="a project's settings are wrong",
    why="The nearest `rulec.toml`, in the working folder or above it, is not TOML, has an unknown "
    "setting, or lists in `search_path` something that is no folder.",
    bad="echo 'search_path = [\"no_such\"]' > rulec.toml\nrulec compile esterle2019 -o out",
    good="mkdir books\necho 'search_path = [\"books\"]' > rulec.toml\n"
    "rulec compile esterle2019 -o out",
    kind="command",
)

NO_OUTPUT = Code(
    "R0720",
    title="standard output cannot be written to",
    why="The disk of the file is full to which the answer is sent, or its device does not take it; "
    "the answer is not whole. Whoever leaves before the end, as `head` does, is no mistake.",
    bad="rulec list > /dev/full",
    good="rulec list > /dev/null",
    kind="command",
)

NO_INPUT = Code(
    "R0721",
    title="standard input cannot be read",
    why="The device that it comes from fails, or it is open for writing alone. `-` stands for it.",
    bad="rulec check - 0> written",
    good="echo 'rulebook a signal p hard rule r { require always p }' | rulec check -",
    kind="command",
)

NO_WORKING_FOLDER = Code(
    "R0722",
    title="there is no working folder any more",
    why="The folder in which the command was started has been removed meanwhile, so that no path "
    "leads anywhere. Change to one that there is.",
    bad="mkdir gone\ncd gone\nrmdir ../gone\nrulec list",
    good="mkdir there\ncd there\nrulec list",
    kind="command",
)

REFUSED_BY_SYSTEM = Code(
    "R0723",
    title="the system does not give what rulec needs",
    why="No further process can be started, no further file opened, or there is no room for "
    "temporary files (in the folder that TMPDIR names); the message says for which file or program "
    "and why. Nothing is wrong with the input.",
    kind="circumstance",
)

LINK_OUT = Code(
    "R0730",
    title="a link leads out of its tree",
    why="A file in a stranger's checkout may be a link to any file of this machine, so rulec "
    "neither reads nor writes through links that lead out of the tree: the git work tree, and "
    "where there is none, the folder that was named. If you do mean that file, give its own path.",
    bad="mkdir books\necho 'rulebook a signal p hard rule r { require always p }' > a.rules\n"
    "ln -s ../a.rules books/a.rules\nrulec check books",
    good="mkdir books\necho 'rulebook a signal p hard rule r { require always p }' > a.rules\n"
    "ln -s ../a.rules books/a.rules\nrulec check a.rules",
    kind="command",
)

NO_ORDINARY_FILE = Code(
    "R0731",
    title="something is no ordinary file",
    why="A pipe, a socket or a device has the name of a source. Reading it might never end, so it "
    "is left alone. Standard input is called `-`.",
    bad="mkfifo pipe.rules\nrulec check .",
    good="mkfifo pipe\necho 'rulebook a signal p hard rule r { require always p }' > pipe &\n"
    "rulec check - < pipe",
    kind="command",
)

OUT_OF_TREE = Code(
    "R0732",
    title="a setting names a folder out of its tree",
    why="A `rulec.toml` may come with a stranger's checkout, so the folders of its `search_path` "
    "lie in the same git work tree, or without one below the file itself, and have relative names.",
    bad="echo 'search_path = [\"/tmp\"]' > rulec.toml\nrulec list",
    good="mkdir books\necho 'search_path = [\"books\"]' > rulec.toml\nrulec list",
    kind="command",
)

NOTHING_LEFT = Code(
    "R0733",
    title="a folder has no source",
    why="No file in or below the folder is called `….rules` and begins with `rulebook` or "
    "`vocabulary`, comments aside; or all of them are left alone, since git ignores them or they "
    "are in an environment such as `venv`. A file that is named itself is never left alone.",
    bad="echo 'package x; rule y' > other.rules\nrulec check .",
    good="echo 'package x; rule y' > other.rules\n"
    "echo 'rulebook a signal p hard rule r { require always p }' > mine.rules\nrulec check .",
    kind="command",
)

NOT_THE_SAME_FILE = Code(
    "R0734",
    title="a file would not be the same after it is rewritten",
    why="What `rulec fmt` changes is a new file with the old one's name, so that none is ever half "
    "written. A file with several names (hard links) would then be two, and one whose owner you "
    "are not might have you for its owner. Such files are left as they are.",
    bad="echo 'rulebook a  signal p hard rule r { require always p }' > a.rules\n"
    "ln a.rules b.rules\nrulec fmt a.rules",
    good="echo 'rulebook a  signal p hard rule r { require always p }' > a.rules\n"
    "cp a.rules b.rules\nrulec fmt a.rules",
    kind="command",
)

OVERWRITES_INPUT = Code(
    "R0735",
    title="an answer would take the place of what is read",
    why="The file that an answer is to be written to is one that the command reads, perhaps by "
    "another path or a link, or a source that is there already. Nothing was read or written. "
    "Give the answer another name.",
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
"""How files begin that people write texts in and that are none."""


def not_utf8(name: str, data: bytes, position: int) -> Diagnostic:
    way_out = "save the file as UTF-8"
    document = next((words for mark, words in _DOCUMENTS.items() if data.startswith(mark)), "")
    if document:
        place = SourceLocation(name, 1, 1, 1, 1)
        return NOT_UTF8.at(
            place, f"the file is {document}, no plain text", help="save it as plain text, in UTF-8"
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
        return "what stands before a `/` in its name is a file, and no folder"
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
    """The error about standard input that cannot be read."""
    return NO_INPUT.error(
        SourceLocation("standard input"),
        f"standard input cannot be read: {reason_in_words(problem)}",
        help="give a file, or what a program writes",
    )


def refused(problem: OSError, *, is_gone: bool) -> Diagnostic:
    """What is said of a refusal of the system that no other message speaks of.

    Of an error with a name in it, it is that file or program, else the working folder if that
    ``is_gone``, else standard output: whatever reads and whatever else writes says its name.
    """
    why = reason_in_words(problem)
    if problem.filename is not None:
        name = os.fsdecode(problem.filename) if not isinstance(problem.filename, int) else "a file"
        help_text = "free what is lacking, and try again"
        return REFUSED_BY_SYSTEM.at(
            SourceLocation(name), f"it cannot be opened or started: {why}", help=help_text
        )
    if is_gone:
        return NO_WORKING_FOLDER.at(
            SourceLocation("."),
            "the working folder is not there any more",
            help="change to one that there is",
        )
    return NO_OUTPUT.at(
        SourceLocation("standard output"),
        f"standard output cannot be written to: {why}",
        help="write to a file elsewhere, with -o FILE",
    )
