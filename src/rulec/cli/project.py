"""The session of the working folder, and what every verb does when rulebooks are wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeVar

import rulec
from rulec.diagnostics import Diagnostic, RulecError
from rulec.report.text.console import print_diagnostics
from rulec.settings import search_path

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook

Answer = TypeVar("Answer")


def open_session(at: str = "") -> rulec.Session:
    """A session with the project's search path that prints warnings. Raises RulecError."""
    return rulec.Session(search_path(), at, print_diagnostics)


def read_machines(rulebook: str, at: str = "") -> CompiledRulebook:
    """A rulebook as automata for traces of any step, after its warnings. Raises RulecError."""
    # The tables of automata, 20 ms: not for --help.
    from rulec.api.workflow import machines

    return machines(rulebook, search_path(), print_diagnostics, at)


@contextmanager
def errors_added_to(diagnostics: list[Diagnostic]) -> Iterator[None]:
    """Go on after what follows, with its mistakes added to those of others."""
    try:
        yield
    except RulecError as error:
        diagnostics += error.diagnostics


def answer_or_print(ask: Callable[[], Answer]) -> Answer | None:
    """The answer to a question; None, after its mistakes, if it cannot be answered."""
    try:
        return ask()
    except RulecError as error:
        print_diagnostics(error.diagnostics)
        return None
