"""The program ``rulec``: find the verb, report exceptions, set the status."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import nullcontext, suppress
from importlib import import_module

import click

from rulec.cache.keeping import keeping
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.interruption import is_interrupted
from rulec.cli.options.verb_class import Invocation, invocation_of
from rulec.cli.verb_table import (
    COMMANDS,
    FORMER,
    OTHER_QUESTIONS,
    VERB_GROUPS,
    VERBS,
    WITH_COMPILED,
    called,
)
from rulec.diagnostics import RulecError
from rulec.diagnostics.argument_names import naming_options
from rulec.diagnostics.fault_messages import faults_found
from rulec.report.text.console import patience
from rulec.report.text.terminal_text import colored, styled, visible, wants_color
from rulec.version import __version__


def _require_signed(context: click.Context, _: click.Parameter, key: str | None) -> None:
    if key:
        context.with_resource(lazy.signature_in_force(key))


_REQUIRE_SIGNED = click.Option(
    ["--require-signed"],
    metavar="PUBLIC_KEY",
    help="Accept only compiled rulebooks signed with this minisign key: the key itself or the path "
    "of its file.",
    expose_value=False,
    callback=_require_signed,
)


def _color(context: click.Context, _: click.Parameter, choice: str | None) -> None:
    if choice is not None:
        context.with_resource(colored(choice))


COLOR = click.Option(
    ["--color"],
    type=click.Choice(["auto", "always", "never"]),
    help="Use colour in text.  [default: auto, that is, on a terminal unless NO_COLOR is set]",
    expose_value=False,
    is_eager=True,
    callback=_color,
)
"""An option of every verb, which may also be given before the verb."""

_QUIET = click.Option(
    ["-q", "--quiet"],
    is_flag=True,
    expose_value=False,
    help="Do not say on standard error what long work is doing.  [default: RULEC_QUIET]",
)


class _Verbs(click.Group):
    """A group that imports a command's file only when that command is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        module, about = COMMANDS[cmd_name]
        command: click.Command = import_module(f"rulec.cli.commands.{module}").command
        command.short_help = about  # also shown by shell completion
        command.name = cmd_name  # in the files every command is called `command`
        if COLOR in command.params:
            return command
        if cmd_name in WITH_COMPILED:
            kinds = command.commands.values() if isinstance(command, click.Group) else (command,)
            for verb in kinds:
                verb.params.append(_REQUIRE_SIGNED)
        command.params += [
            click.Option([word], is_flag=True, expose_value=False, help=_other(cmd_name, word))
            for word in OTHER_QUESTIONS.get(cmd_name, ())
            if word.startswith("--")
        ]
        command.params += [COLOR, _QUIET]
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args[0].startswith("-"):
            return super().resolve_command(ctx, args)
        if args[0] not in VERBS and args[0] not in FORMER:
            ctx.fail(lazy.unknown_verb(args[0]))
        if args[0] in FORMER and not ctx.resilient_parsing:
            _say(f"`rulec {args[0]}` is now called `rulec {FORMER[args[0]]}`")
        name, arguments = called(args)
        return name, self.get_command(ctx, name), arguments

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        width = max(map(len, VERBS))
        for title, verbs in VERB_GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(verb.ljust(width), about) for verb, about in verbs.items()])


def _other(verb: str, word: str) -> str:
    about = COMMANDS[f"{verb} {word}"][1]
    return f"{about} It has options of its own: `rulec {verb} {word} --help`."


@click.command(
    cls=_Verbs,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    params=[COLOR, _QUIET],
    epilog="`rulec help COMMAND` describes a command.  Exit status: 0 success, 1 a hard rule is "
    "violated or a mistake was found, 2 no answer was possible, 70 a bug in rulec.",
)
@click.version_option(__version__, "-V", "--version", message="rulec %(version)s")
@click.option(
    "--limit",
    "limits",
    multiple=True,
    metavar="NAME=NUMBER",
    help="Raise or lower a limit on the cost of a computation, such as choices=5000000; may be "
    "given several times.  [default: RULEC_LIMITS]",
)
@click.pass_context
def rulec(context: click.Context, limits: Sequence[str]) -> None:
    """Compile traffic law into automata, and judge traces and maneuvers with them."""
    context.with_resource(keeping())
    if limits:
        context.with_resource(lazy.limits_in_force(limits))
    if context.invoked_subcommand is not None and invocation_of(context).is_program:
        context.with_resource(lazy.enforced())
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit status."""
    given = sys.argv[1:] if arguments is None else arguments
    faults_found()
    # Whoever calls this in a program of its own has the say over signals and standard error.
    long_work = patience(given) if arguments is None else nullcontext()
    with naming_options(), long_work:
        try:
            outcome = rulec.main(
                args=list(given),
                prog_name="rulec",
                obj=Invocation(tuple(given), is_program=arguments is None),
                standalone_mode=False,
            )
            sys.stdout.flush()
        except BaseException as problem:
            return _status_after(problem)
    status = outcome if isinstance(outcome, int) else ExitStatus.OK
    if found := faults_found():
        lazy.print_diagnostics(
            [fault for fault in found if fault.message not in lazy.diagnostics_text.printed]
        )
        return ExitStatus.NOT_ANSWERED
    return status


def _status_after(problem: BaseException) -> int:
    """Print the reason why a command ended, and return its exit status."""
    if is_interrupted() or isinstance(problem, click.Abort | KeyboardInterrupt):
        _say("interrupted")
        return ExitStatus.INTERRUPTED
    problem = lazy.limit_error(problem) or problem
    match problem:
        case click.ClickException():
            _say_misuse(problem)
            return ExitStatus.NOT_ANSWERED
        case RulecError():
            lazy.print_diagnostics(problem.diagnostics)
            return ExitStatus.NOT_ANSWERED
        case SystemExit():
            # click exits with 1 if the reader is gone; signals set their own status.
            return ExitStatus.READER_GONE if problem.code == 1 else int(problem.code or 0)
        case OSError():
            return _refused(problem)
        case Exception():
            return _bug(problem)
    raise problem


def _bug(problem: Exception) -> int:
    if os.environ.get("RULEC_TRACEBACK"):
        lazy.print_exception(problem)
        return ExitStatus.BUG
    _say(
        f"this is a bug in rulec {__version__}: "
        f"{_visible(f'{type(problem).__name__}: {problem}')}\n"
        "Please report it, with the input and what this prints: "
        f"RULEC_TRACEBACK=1 {_visible(' '.join(sys.argv))}"
    )
    return ExitStatus.BUG


def _refused(problem: OSError) -> int:
    # Discard buffered output, so that it does not fail again when Python exits.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if isinstance(problem, BrokenPipeError):
        return ExitStatus.READER_GONE
    with suppress(OSError):
        lazy.print_diagnostics(
            [lazy.file_messages.refused(problem, is_gone=not _has_working_folder())]
        )
    return ExitStatus.NOT_ANSWERED


def _has_working_folder() -> bool:
    try:
        return bool(os.getcwd())  # noqa: PTH109 - the cheapest
    except OSError:
        return False


def _visible(text: str) -> str:
    return lazy.outgoing(visible(text))


def _say(text: str) -> None:
    with suppress(OSError):
        click.echo(f"rulec: {text}", err=True)


def _say_misuse(problem: click.ClickException) -> None:
    """Print a usage error in the format of other diagnostics, with advice."""
    color = wants_color(sys.stderr)
    text = _visible(lazy.usage_help.reworded(problem))
    message = f"{styled('error', 'bold red', color)}: {text}"
    context = getattr(problem, "ctx", None)
    if context is not None:
        help_of = context.command_path.replace("rulec", "rulec help", 1)
        usage = " ".join(context.command.collect_usage_pieces(context))
        if isinstance(problem, click.UsageError):
            message += "".join(f"\n  = help: {way_out}" for way_out in lazy.ways_out(problem))
        message += f"\n  = usage: {context.command_path} {usage}\n  = help: `{help_of}` says more"
    with suppress(OSError):
        click.echo(message, err=True, color=color)
