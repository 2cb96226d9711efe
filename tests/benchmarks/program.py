"""A benchmark as a program: ``FILE [--json] [ROUNDS]``."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable

import msgspec
from figure import Result, as_text


def run(measure: Callable[[int], Iterable[Result]], rounds: int) -> None:
    """Measure, in ``rounds`` rounds unless the command line says how many; print every result."""
    arguments = sys.argv[1:]
    in_json = "--json" in arguments
    for argument in arguments:
        if argument != "--json":
            rounds = int(argument)
    for result in measure(rounds):
        print(msgspec.json.encode(result).decode() if in_json else as_text(result), flush=True)
