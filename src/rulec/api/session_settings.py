"""Settings shared by all verbs of a session."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from datetime import date
from inspect import isfunction
from pathlib import Path
from typing import TYPE_CHECKING

from rulec.api import lazy_imports as lazy
from rulec.diagnostics import Diagnostic
from rulec.diagnostics.argument_kinds import checked_kinds, expected

if TYPE_CHECKING:
    from rulec.api.rulebook_compilation import Rules
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook


def ignore(_: object) -> None:
    """Ignore warnings or progress."""


@dataclass(frozen=True)
class SessionSettings:
    """Search path of rulebooks, day of the law, and listener for warnings.

    Args:
        search_path: folders of rulebooks and vocabularies, before those that ship with rulec.
        at: the day (ISO) whose law applies; if empty, that of each rulebook's `law` line or else
            today.
        on_warning: called with warnings about a source.
    """

    search_path: Sequence[str | Path] = ()
    at: str = ""
    on_warning: Callable[[Sequence[Diagnostic]], object] = field(default=ignore, repr=False)

    def __init_subclass__(cls) -> None:
        """Make every verb check the types of its arguments."""
        # A verb with two names stays one function
        checked = {verb: checked_kinds(verb) for verb in vars(cls).values() if isfunction(verb)}
        for name, verb in list(vars(cls).items()):
            if isfunction(verb) and not name.startswith("_"):
                setattr(cls, name, checked[verb])

    def __post_init__(self) -> None:
        folders = expected("search_path", "Sequence[str | Path]", self.search_path)
        object.__setattr__(self, "search_path", folders)
        expected("at", "str", self.at)
        expected("on_warning", "Callable[[object], object]", self.on_warning)
        if self.at:
            try:
                date.fromisoformat(self.at)
            except ValueError:
                message = f"`at` is `{self.at:.40}`, which is no day such as 2026-01-31"
                raise ValueError(message) from None

    def _warn(self, diagnostics: Sequence[Diagnostic]) -> None:
        if diagnostics:
            self.on_warning(diagnostics)

    def _folders(self) -> tuple[Path, ...]:
        return tuple(Path(folder) for folder in self.search_path)

    def _compiled(self, rules: Rules) -> CompiledRulebook:
        return lazy.machines(rules, self.search_path, self._warn, self.at)
