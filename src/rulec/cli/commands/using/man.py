"""``rulec help --man``: all commands as a manual page."""

from __future__ import annotations

from collections.abc import Iterator
from inspect import cleandoc

import click

from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.verb_class import verb
from rulec.cli.output import put_answer
from rulec.cli.verb_table import COMMANDS, VERB_GROUPS
from rulec.version import __version__


@verb
@click.pass_context
def command(
    context: click.Context,
    *,
    to: Output = output_options(endings_of("roff"), "the page"),
) -> None:
    """Write the manual page rulec(1), with every command and its options.

    \b
    rulec help --man -o ~/.local/share/man/man1/rulec.1    for `man rulec`
    rulec help --man | man -l -                            to read it at once
    """  # noqa: D301 - click reads the backspace
    put_answer(manual_page(context.find_root()), to)


def manual_page(root: click.Context) -> str:
    """The manual page of a program's group of commands, in the macros of man(7).

    It has no date, so that the same program always has the same page.
    """
    assert isinstance(root.command, click.Group), "the program has verbs"
    lines = [f'.TH RULEC 1 "" "rulec {__version__}" "User Commands"', ".SH NAME"]
    lines += [f"rulec {_DASH} {_plain(_first_line(root.command))}", ".SH SYNOPSIS"]
    lines += [f".B rulec\n{_plain(_usage(root))}", ".SH OPTIONS", *_options(root)]
    for title, verbs in VERB_GROUPS.items():
        lines.append(f".SH {_plain(title.upper())}")
        for name in (name for name in COMMANDS if name.split()[0] in verbs):
            command = root.command.get_command(root, name)
            assert command is not None, "the table has commands only"
            lines += _command(click.Context(command, root, name))
    lines += [".SH EXIT STATUS", _plain(_EXIT_STATUS)]
    lines += [".SH ENVIRONMENT"]
    for name, meaning in _ENVIRONMENT.items():
        lines += [".TP", f".B {name}", _plain(meaning)]
    return "\n".join(lines)


_DASH = r"\-"

_EXIT_STATUS = (
    "0 done, and all is well; 1 a hard rule is violated or a mistake is found; 2 the question "
    "could not be answered; 70 a bug in rulec; 129, 130 and 143 a signal; 141 the reader has left."
)

_ENVIRONMENT = {
    "RULEC_CACHE_DIR": "The folder of the cache of checked, formatted and compiled files, in place "
    "of $XDG_CACHE_HOME/rulec or ~/.cache/rulec.",
    "RULEC_JOBS": "The number of processes, where -j does not give it.",
    "RULEC_LIMITS": "Limits to raise or lower, written as for --limit.",
    "NO_COLOR, FORCE_COLOR": "No colour at all, or colour even in pipes; --color overrides both.",
}


def _command(context: click.Context) -> Iterator[str]:
    """A command, and its subcommands."""
    yield f'.SS "{_plain(context.command_path)} {_plain(_usage(context))}"'
    for number, paragraph in enumerate(cleandoc(context.command.help or "").split("\n\n")):
        if number:
            yield ".PP"
        if paragraph.startswith("\b\n"):
            yield f".nf\n{_plain(paragraph[2:])}\n.fi"
        else:
            yield _plain(" ".join(paragraph.split()))
    yield from _options(context)
    if isinstance(context.command, click.Group):
        for name in context.command.list_commands(context):
            inner = context.command.get_command(context, name)
            assert inner is not None, "a group knows its own commands"
            yield from _command(click.Context(inner, context, name))


def _options(context: click.Context) -> Iterator[str]:
    for parameter in context.command.get_params(context):
        record = parameter.get_help_record(context)
        # Arguments are described in the text above.
        if record is not None and isinstance(parameter, click.Option):
            option, meaning = record
            yield f".TP\n.B {_plain(option)}\n{_plain(meaning)}"


def _usage(context: click.Context) -> str:
    return " ".join(context.command.collect_usage_pieces(context))


def _first_line(command: click.Command) -> str:
    return cleandoc(command.help or "").partition("\n")[0].rstrip(".")


def _plain(text: str) -> str:
    """A text with everything escaped that roff would take for a request."""
    escaped = text.replace("\\", r"\e").replace("-", r"\-").replace('"', r"\(dq")
    return "\n".join(
        rf"\&{line}" if line[:1] in (".", "'") else line for line in escaped.split("\n")
    )
