"""Standard input in place of a file, which may be read more than once, or from its middle."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO, Any, cast

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.options.verb_class import invocation_of
from rulec.files.file_messages import no_input
from rulec.files.read_files import STANDARD_INPUT_COPY, opened
from rulec.files.written_files import TEMPORARY, temporary_files
from rulec.resources import variable_set

STANDARD_INPUT = "-"

_OUTPUTS = frozenset({"-o", "--output", "--save", "--witness"})
"""Options for which ``-`` means standard output."""


def standard_input() -> IO[bytes]:
    """Standard input, with an error message if it cannot be read.

    Raises RulecError, while it is read: R0721.
    """
    return cast("IO[bytes]", io.BufferedReader(_StandardInput()))


@contextmanager
def input_stream(path: str) -> Iterator[tuple[IO[bytes], str]]:
    """A file opened for reading, or standard input for ``-``, and its name in messages."""
    if path == STANDARD_INPUT:
        yield standard_input(), "standard input"
    else:
        with opened(Path(path)) as stream:
            yield stream, path


class _StandardInput(io.RawIOBase):
    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return sys.stdin.buffer.seekable()

    def seek(self, offset: int, whence: int = 0) -> int:
        return sys.stdin.buffer.seek(offset, whence)

    def tell(self) -> int:
        return sys.stdin.buffer.tell()

    def readinto(self, buffer: Any) -> int:
        try:
            data = cast("io.BufferedReader", sys.stdin.buffer).read1(len(buffer))
        except OSError as problem:
            raise no_input(problem) from None
        buffer[: len(data)] = data
        return len(data)


def file_named(argument: str) -> str:
    """The path for an argument; for ``-`` that of a copy, which exists until the command ends."""
    if argument != STANDARD_INPUT:
        return argument
    return str(click.get_current_context().with_resource(copied()))


def read_as_file(
    context: click.Context, _: click.Parameter, value: Any, ending: str = ".rules"
) -> Any:
    """A click callback for file names, with ``-`` replaced by a copy of standard input.

    Files that it refers to are looked up in the working folder. The copy's name has this ``ending``
    unless it is JSON.

    Raises:
        click.UsageError: standard input is requested twice.
    """
    several = value if isinstance(value, tuple) else (value,)
    if STANDARD_INPUT not in several or context.resilient_parsing:
        return value
    refuse_twice(context)
    name = context.with_resource(_in_place_of_a_file(ending))
    named = tuple([name if own == STANDARD_INPUT else own for own in several])
    return named if isinstance(value, tuple) else named[0]


def not_standard_input(why: str) -> Callable[[click.Context, click.Parameter, Any], Any]:
    """A click callback that refuses ``-`` where standard input is impossible, saying ``why``."""

    def refused(_: click.Context, __: click.Parameter, value: Any) -> Any:
        if STANDARD_INPUT in (value if isinstance(value, tuple) else (value,)):
            raise click.BadParameter(f"`-` is standard input: {why}")
        return value

    return refused


def refuse_twice(context: click.Context) -> None:
    """Refuse a command that would read standard input in two ways.

    Raises:
        click.UsageError: it would.
    """
    arguments = invocation_of(context).arguments
    readers = [
        own
        for before, own in zip(("", *arguments), arguments, strict=False)
        if (own == STANDARD_INPUT and before not in _OUTPUTS) or own in ("-r-", "--rulebook=-")
    ]
    if len(readers) > 1:
        raise click.UsageError("`-` is standard input, read only once; give a file for another")


@contextmanager
def _in_place_of_a_file(usual: str) -> Iterator[str]:
    """The name of a file in the working folder that represents a copy of standard input."""
    with copied() as copy:
        with opened(copy) as stream:
            ending = ".json" if stream.read(1 << 10).lstrip().startswith(b"{") else usual
        number = 1
        while (
            name := Path(f"standard input{'' if number == 1 else f' {number}'}{ending}")
        ).exists():
            number += 1
        with variable_set(STANDARD_INPUT_COPY, str(copy.rename(copy.with_name(name.name)))):
            yield str(name)


@contextmanager
def copied() -> Iterator[Path]:
    """A copy of standard input, which may be read more than once, and from its middle."""
    with ExitStack() as stack:
        with temporary_files():
            folder = stack.enter_context(lazy.TemporaryDirectory(prefix=TEMPORARY))
            copy = Path(folder, "standard input")
            with copy.open("wb") as stream:
                lazy.shutil.copyfileobj(standard_input(), stream)
        yield copy
