"""The class of all verbs, and how a function's parameters say what a verb asks for.

The default of a parameter, or of a field of a class of options, is what asks for its value: it
takes the name, and gives a decorator of click. The order is that of the help text.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial, wraps
from inspect import unwrap
from typing import Any, TypeVar, cast

import click

Decorated = TypeVar("Decorated", bound=Callable[..., Any])


def option(*names: str, **settings: Any) -> Any:
    """An option with these names and settings of click."""
    return partial(click.option, *names, **settings)


def argument(**settings: Any) -> Any:
    """An argument with these settings of click."""
    return partial(click.argument, **settings)


def asking(function: Decorated) -> Decorated:
    """A function that is called with the values that its parameters ask for."""
    asked: dict[str, Any] = unwrap(function).__kwdefaults__
    for name, make in reversed(asked.items()):
        function = make(name)(function)
    return function


def gathered(kind: type[Any]) -> Any:
    """All that the fields of a class ask for, of which a function gets an object."""
    # Own options come before those that all recordings have.
    order = sorted(fields(kind), key=lambda one: one.name not in kind.__annotations__)

    def make(parameter: str) -> Callable[[Decorated], Decorated]:
        def decorate(function: Decorated) -> Decorated:
            @wraps(function)
            def called(**values: Any) -> Any:
                own = {one.name: values.pop(one.name) for one in order}
                return function(**values, **{parameter: kind(**own)})

            decorated = cast("Decorated", called)
            for one in reversed(order):
                decorated = one.default(one.name)(decorated)
            return decorated

        return decorate

    return make


class Verb(click.Command):
    """A command that accepts an option only once, unless it is repeatable."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the arguments. Raises click.UsageError."""
        if not ctx.resilient_parsing:
            _refuse_one_dash(self, ctx, args)
            _refuse_repeated(self, ctx, args)
        return super().parse_args(ctx, args)


def verb(function: Callable[..., Any]) -> click.Command:
    """The command of a function whose parameters say what they ask for."""
    return click.command(cls=Verb)(asking(function))


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
