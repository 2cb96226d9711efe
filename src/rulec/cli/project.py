"""The session of the working folder, and the handling of wrong rulebooks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeVar

import rulec
from rulec.diagnostics import Diagnostic, RulecError
from rulec.report.findings.diagnostics_text import print_diagnostics
from rulec.settings import search_path

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook

Answer = TypeVar("Answer")


def open_session(at: str = "") -> rulec.Session:
    """A session with the project's search path that prints warnings. Raises RulecError."""
    return rulec.Session(search_path(), at, print_diagnostics)


def read_machines(rulebook: str, at: str = "") -> CompiledRulebook:
    """Compile a rulebook for any step; print warnings. Raises RulecError."""
    # The tables of automata, 20 ms: not for --help.
    from rulec.api.rulebook_compilation import machines

    return machines(rulebook, search_path(), print_diagnostics, at)


@contextmanager
def errors_added_to(diagnostics: list[Diagnostic]) -> Iterator[None]:
    """Run a block and collect its errors instead of raising them."""
    try:
        yield
    except RulecError as error:
        diagnostics += error.diagnostics


def answer_or_print(ask: Callable[[], Answer]) -> Answer | None:
    """The answer to a question, or None after its errors are printed."""
    try:
        return ask()
    except RulecError as error:
        print_diagnostics(error.diagnostics)
        return None
