"""How rulec was called: its arguments, and whether the process is its own."""

from __future__ import annotations

from dataclasses import dataclass

import click


@dataclass(frozen=True, slots=True)
class Invocation:
    """The arguments, and ``is_program``: whether limits of the process are rulec's to set."""

    arguments: tuple[str, ...] = ()
    is_program: bool = False


def invocation_of(context: click.Context | None) -> Invocation:
    """The invocation that a context belongs to."""
    found = None if context is None else context.find_root().obj
    return found if isinstance(found, Invocation) else Invocation()
