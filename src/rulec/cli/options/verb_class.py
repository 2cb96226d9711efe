"""The class of all verbs, which refuses repeated options and surplus arguments."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import click


class Verb(click.Command):
    """A command that accepts an option only once, unless it is repeatable."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the arguments. Raises click.UsageError."""
        if not ctx.resilient_parsing:
            _refuse_one_dash(self, ctx, args)
            _refuse_repeated(self, ctx, args)
        return super().parse_args(ctx, args)


class VerbGroup(click.Group):
    """A group of verbs, such as ``draw``."""

    command_class = Verb


def _refuse_one_dash(verb: Verb, context: click.Context, arguments: list[str]) -> None:
    """Refuse ``-rulebook``, which would mean ``-r ulebook``."""
    known = {name for option in verb.params for name in option.opts if name.startswith("--")}
    for word in arguments:
        if word == "--":
            return
        name = word.partition("=")[0]
        if len(name) > 2 and not name.startswith("--") and f"-{name}" in known:
            message = f"there is no option `{name}`; did you mean `-{name}`?"
            raise click.UsageError(message, context)


def _refuse_repeated(verb: Verb, context: click.Context, arguments: list[str]) -> None:
    *_, order = verb.make_parser(context).parse_args(args=[*arguments])
    for parameter, times in Counter(order).items():
        # Repeating a flag is harmless.
        once = isinstance(parameter, click.Option) and not (
            parameter.multiple or parameter.is_flag or parameter.count
        )
        if once and times > 1:
            number = "twice" if times == 2 else f"{times} times"
            name = parameter.opts[-1]
            raise click.UsageError(f"{name} is given {number}, and takes one value", context)


@dataclass(frozen=True, slots=True)
class Invocation:
    """The arguments, and ``is_program``: whether limits of the process are rulec's to set."""

    arguments: tuple[str, ...] = ()
    is_program: bool = False


def invocation_of(context: click.Context | None) -> Invocation:
    """The invocation that a context belongs to."""
    found = None if context is None else context.find_root().obj
    return found if isinstance(found, Invocation) else Invocation()
