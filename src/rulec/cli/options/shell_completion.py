"""Shell completion of file names and of names that rulec knows."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

import click

from rulec.cli import lazy_imports as lazy
from rulec.diagnostics import RulecError
from rulec.rulebook.files.search_path import available_rulebooks, available_vocabularies
from rulec.settings import search_path

Completion = Callable[[click.Context, click.Parameter, str], "list[lazy.CompletionItem]"]
"""What click calls for an argument, with its beginning."""


def _completing(names: Callable[[], Iterable[str]]) -> Completion:
    """Names that begin so, and files."""

    def complete(
        ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[lazy.CompletionItem]:
        fitting = [_item(name) for name in names() if name.startswith(incomplete)]
        # The first item makes the shell also offer files whose paths begin so.
        return [_item(incomplete, kind="file"), *fitting]

    return complete


complete_rulebooks = _completing(lambda: available_rulebooks(_folders()))
complete_sources = _completing(
    lambda: [
        *available_rulebooks(_folders()),
        *(path.stem for path in available_vocabularies(_folders())),
    ]
)
complete_scenarios = _completing(lambda: lazy.available_scenarios())


def complete_rules(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[lazy.CompletionItem]:
    """Complete rule names of the given rulebook, with their titles."""
    reference = str(ctx.params.get("rulebook"))
    try:
        compiled = Path(reference).suffix == ".json"
        rules = (
            lazy.read_compiled(Path(reference)).rules
            if compiled
            else lazy.load_rulebook(reference, _folders()).rules
        )
    except RulecError:
        return []
    return [
        _item(rule.name, rule.says or None) for rule in rules if rule.name.startswith(incomplete)
    ]


def complete_codes(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[lazy.CompletionItem]:
    """Codes of messages, with their titles."""
    return [
        _item(text, code.title)
        for text, code in lazy.all_codes().items()
        if text.startswith(incomplete.upper())
    ]


def _folders() -> tuple[Path, ...]:
    """The project's own folders; empty, without a message, if its settings are wrong."""
    try:
        return search_path()
    except RulecError:
        return ()


def _item(value: str, about: str | None = None, kind: str = "plain") -> lazy.CompletionItem:
    return lazy.CompletionItem(value, type=kind, help=about)
