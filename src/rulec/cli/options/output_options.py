"""Options for the output's destination and format, the same for all verbs.

The file's extension determines the format, or `--output-format` (short form `--json`) if it does
not. Ambiguous options are refused before the verb begins.
"""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, fields, is_dataclass
from functools import wraps
from pathlib import Path
from typing import Any, cast

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.options.verb_class import Decorated, option
from rulec.diagnostics import RulecError, SourceLocation
from rulec.files.file_messages import OVERWRITES_INPUT
from rulec.files.read_files import from_here
from rulec.files.work_trees import is_ordinary
from rulec.files.written_files import refuse_unwritable
from rulec.report.findings.finding_formats import ENDINGS
from rulec.report.text.console import print_remark

Endings = Mapping[str, Sequence[str]]
"""Format -> its file extensions. The first format is the default."""

_TEXT = (".txt",)

_ENDINGS: Endings = {
    **ENDINGS,
    "text": _TEXT,
    "full": _TEXT,
    "concise": _TEXT,
    "github": _TEXT,
    "markdown": (".md", ".markdown"),
    "html": (".html", ".htm"),
    "json": (".json",),
    "dot": (".dot", ".gv"),
    "svg": (".svg",),
    "png": (".png",),
    "pdf": (".pdf",),
    "roff": (".1", ".man"),
}

_BINARY = frozenset({"mcap", "parquet", "pdf", "png"})
"""Formats that a terminal cannot show."""

STANDARD_OUTPUT = "-"


def endings_of(*formats: str) -> Endings:
    """The file extensions of these formats; the first format is the default."""
    return {form: _ENDINGS[form] for form in formats}


TABLES = endings_of("jsonl", "csv", "parquet")
"""The formats of traces and of tables."""


@dataclass(frozen=True, slots=True)
class Output:
    """The path of a file, or `-` for standard output, and the format to write."""

    path: str
    form: str

    @property
    def is_file(self) -> bool:
        """Whether it is a file, not standard output."""
        return self.path != STANDARD_OUTPUT

    @property
    def is_folder(self) -> bool:
        """Whether the path is a folder: an existing one, or one that ends with ``/``."""
        return self.path.endswith("/") or os.path.isdir(self.path)  # noqa: PTH112


class RenamedOption(click.Option):
    """An option that also accepts its ``former`` names, which are no longer shown."""

    def __init__(self, *declared: Any, former: Sequence[str] = (), **settings: Any) -> None:
        super().__init__(*declared, **settings)
        self.former = [*former]

    def add_to_parser(self, parser: Any, ctx: click.Context) -> None:
        """Register all names with the parser."""
        shown, self.opts = self.opts, [*self.opts, *self.former]
        try:
            super().add_to_parser(parser, ctx)
        finally:
            self.opts = shown


def input_format_option(names: Sequence[str], content: str, former: Sequence[str] = ()) -> Any:
    """``--input-format NAME``, which formerly had the names ``former``."""
    return option(
        "--input-format",
        cls=RenamedOption,
        former=former,
        metavar="NAME",
        type=click.Choice(names),
        help=f"The format of {content}.",
    )


def output_options(
    endings: Endings,
    content: str,
    *,
    required: bool = False,
    multiple: bool = False,
    former: Sequence[str] = (),
    alias: str = "",
    instead: str = "",
    folders: bool = False,
) -> Any:
    """``-o FILE``, ``--output-format NAME`` and, if ``json`` is a format, ``--json``.

    The verb receives an Output; with ``multiple`` a tuple of them.

    Args:
        endings: the formats.
        content: what is written, for the help text.
        required: a file is needed; standard output has to be requested.
        multiple: several files are allowed.
        former: former names of ``--output-format``.
        alias: the parameter of a further option that may name a format.
        instead: advice if none of the formats is the wanted one.
        folders: FILE may be a folder, with one file for each item.
    """
    default = next(iter(endings))
    has_json = "json" in endings
    options = [
        click.option(
            "-o",
            "--output",
            "outputs",
            required=required,
            multiple=True,
            metavar="FILE",
            type=click.Path(dir_okay=folders, allow_dash=True),
            help=f"Write {content} to FILE, whose extension selects the format; `-` is standard "
            "output."
            + (" Several are written to a folder, `DIR/`." if folders else "")
            + (" May be given several times." if multiple else "")
            + ("" if required else "  [default: standard output]"),
        ),
        click.option(
            "--output-format",
            "output_format",
            cls=RenamedOption,
            former=former,
            type=click.Choice(list(endings)),
            help=f"The format of {content}.  [default: by the extension of FILE; {default} on "
            "standard output]",
        ),
    ]
    if has_json:
        options.append(
            click.option(
                "--json", "json_output", is_flag=True, help="The same as --output-format json."
            )
        )

    def make(parameter: str) -> Callable[[Decorated], Decorated]:
        def decorate(function: Decorated) -> Decorated:
            @wraps(function)
            def called(**values: Any) -> Any:
                outputs, output_format = values.pop("outputs"), values.pop("output_format")
                named = {f"--output-format {output_format}": output_format}
                named |= {"--json": "json" if has_json and values.pop("json_output") else None}
                also = values.get(alias)
                named |= {f"--{alias} {also}": also if also in endings else None}
                form = _one_format({option: name for option, name in named.items() if name})
                if len(outputs) > 1 and not multiple:
                    raise click.UsageError("-o is given twice; there is one answer.")
                if len(outputs) > 1 and form is not None:
                    raise click.UsageError(
                        "With several files, the ending of each decides its format."
                    )
                to = tuple(
                    Output(path, chosen_format(endings, path, form, instead=instead))
                    for path in outputs or (STANDARD_OUTPUT,)
                )
                _refuse_doubtful(to, values)
                with _old_files_told(to):
                    return function(**values, **{parameter: to if multiple else to[0]})

            decorated = cast("Decorated", called)
            for one in reversed(options):
                decorated = one(decorated)
            return decorated

        return decorate

    return make


def chosen_format(
    endings: Endings, path: str, named: str | None = None, *, instead: str = ""
) -> str:
    """The format given by a file's extension, else the one ``named``.

    On standard output, and on devices, which have no extension, the default is the first.

    Raises:
        click.UsageError: the extension is unknown, or contradicts the named format.
    """
    name = Path(path).name.lower()
    fitting = {
        form: max((len(suffix) for suffix in suffixes if name.endswith(suffix)), default=0)
        for form, suffixes in endings.items()
    }
    longest = max(fitting.values())
    by_ending = [form for form, length in fitting.items() if length == longest > 0]
    is_stream = path == STANDARD_OUTPUT or _is_device(Path(path)) or Output(path, "").is_folder
    if named is not None:
        if by_ending and named not in by_ending and not is_stream:
            raise click.UsageError(
                f"`{path}` says by its ending that it is {by_ending[0]}, and not {named}. Give it "
                f"another ending, such as {endings[named][0]}, or leave out the format."
            )
        return named
    if is_stream:
        return next(iter(endings))
    if by_ending:
        return by_ending[0]
    known = ", ".join(dict.fromkeys(suffix for ending in endings.values() for suffix in ending))
    raise click.UsageError(
        f"`{path}` does not say by its ending what to write. Let it end in one of {known}, or "
        f"name the format: --output-format {next(iter(endings))}{instead and f'. {instead}'}"
    )


def _one_format(named: Mapping[str, str]) -> str | None:
    """The format that these options name, if any. Raises click.UsageError if they differ."""
    if len(set(named.values())) > 1:
        raise click.UsageError(f"{' and '.join(named)} contradict each other.")
    return next(iter(named.values()), None)


@contextmanager
def _old_files_told(to: Sequence[Output]) -> Iterator[None]:
    """Say afterwards which files are still those of an earlier call, since none was written."""
    before = {output.path: _version(output.path) for output in to if output.is_file}
    try:
        yield
    finally:
        for path, version in before.items():
            if version is not None and version == _version(path):
                print_remark(f"rulec: {path} was not written; it is that of an earlier call")


def _version(path: str) -> tuple[int, int] | None:
    """What a file has that replaces another one; None if there is no ordinary file."""
    with suppress(OSError, ValueError):
        status = os.stat(path)  # noqa: PTH116 - Path raises on a null character
        return (status.st_ino, status.st_mtime_ns) if stat.S_ISREG(status.st_mode) else None
    return None


def _refuse_doubtful(to: Sequence[Output], values: Mapping[str, Any]) -> None:
    """Refuse outputs that a terminal cannot show, or that would overwrite another file.

    Raises:
        click.UsageError: one of them would.
        RulecError: R0702 or R0730, one of them cannot be written.
    """
    if sum(not output.is_file for output in to) > 1:
        raise click.UsageError("standard output can have only one format.")
    for output in to:
        if not output.is_file and output.form in _BINARY and sys.stdout.isatty():
            raise click.UsageError(f"{output.form} is no text: write it to a file, with -o FILE")
    written = [output.path for output in to if output.is_file]
    if len(set(map(_identity, written))) < len(written):
        raise click.UsageError("-o names the same file twice.")
    refuse_overwriting(to, list(_texts(values.values())))
    for output in to:
        if output.is_file and not output.is_folder:
            refuse_unwritable(Path(output.path))
    for name, goes_on in _ALSO_WRITTEN.items():
        read = (value for other, value in values.items() if other not in (name, goes_on))
        for path in _texts([values.get(name)]):
            refuse_overwriting([Output(path, "")], list(_texts(read)))


_ALSO_WRITTEN = {"save": "restore", "witness": ""}
"""Parameters for files written besides the answer -> the input that may be the same file."""


def refuse_overwriting(to: Sequence[Output], paths: Iterable[str]) -> None:
    """Refuse outputs that are also given elsewhere, such as inputs, and existing sources.

    Links and other spellings of a path count as the same file.

    Raises:
        RulecError: R0735, one of them is among these paths, or a source, settings, a map, or a file
            that is read along with recordings.
    """
    files = {_identity(output.path): output.path for output in to if output.is_file}
    for path in paths if files else ():
        is_path = path not in ("", STANDARD_OUTPUT) and "\0" not in path
        if is_path and _identity(path) in files and not _is_device(Path(path)):
            raise _overwrites(path, f"`{path}` is named already, and would be overwritten")
    for path in files.values():
        _refuse_what_is_read(path)
        # What a link leads to would be overwritten, whatever the link is called.
        if Path(path).is_symlink():
            _refuse_what_is_read(from_here(os.path.realpath(path)))


def _refuse_what_is_read(path: str) -> None:
    """Refuse to overwrite a file that may be read without being named.

    Raises RulecError R0735.
    """
    if path.endswith(".rules") and os.path.lexists(path):
        raise _overwrites(path, f"`{path}` is a source, and would be overwritten")
    if Path(path).name in _OF_PROJECTS and os.path.lexists(path):
        raise _overwrites(path, f"`{path}` is a project's own, and would be overwritten")
    if is_ordinary(Path(path)) and lazy.is_beside_recordings(path):
        message = f"`{path}` is recorded traffic, a map, or read along with these, and would be"
        raise _overwrites(path, f"{message} overwritten")


_OF_PROJECTS = ("rulec.toml", "rulec.lock")


def refuse_standard_output(folder: str) -> None:
    """Refuse ``-`` as a folder.

    Raises:
        click.UsageError: the folder is ``-``.
    """
    if folder == STANDARD_OUTPUT:
        raise click.UsageError("`-` is standard output, and no folder; one of that name is `./-`.")


def _overwrites(path: str, message: str) -> RulecError:
    return OVERWRITES_INPUT.error(SourceLocation(path), message, help="give another file")


def _identity(path: str) -> object:
    """A value that is the same for all paths of a file, even one that does not exist yet."""
    try:
        status = Path(path).stat()
    except (OSError, ValueError):
        return os.path.realpath(path)
    return status.st_dev, status.st_ino


def _texts(values: Iterable[Any]) -> Iterator[str]:
    """Texts in other parameters that may be paths."""
    for value in values:
        if is_dataclass(value):
            yield from _texts(getattr(value, one.name) for one in fields(value))
        for choice in value if isinstance(value, tuple) else (value,):
            if isinstance(choice, str | Path):
                yield str(choice)


def _is_device(path: Path) -> bool:
    """Whether a path is a pipe or a device such as /dev/null."""
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):  # ValueError: a null character in the name
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))
