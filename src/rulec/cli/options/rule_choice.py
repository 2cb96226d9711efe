"""The rules that `--rule PATTERN` chooses from rulebooks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fnmatch import fnmatchcase

import click

from rulec.cli import lazy_imports as lazy
from rulec.diagnostics import did_you_mean


def refuse_unmatched(
    patterns: Sequence[str], books: Sequence[lazy.Rulebook] | Sequence[lazy.CompiledRulebook]
) -> None:
    """Refuse a pattern that matches no rule: nothing to report would look like nothing found.

    Raises click.BadParameter.
    """
    known = {rule.name for book in books for rule in book.rules}
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in known):
            near = did_you_mean(pattern, known)
            whose = (
                f"{books[0].name} has no" if len(books) == 1 else "none of these rulebooks has a"
            )
            raise click.BadParameter(
                f"{whose} rule like `{pattern}`{near and f'; {near}'}", param_hint="--rule"
            )


def rules_on_topic(books: Sequence[lazy.Rulebook], topic: str) -> tuple[lazy.Rulebook, ...]:
    """The rulebooks with only their rules on a topic. Raises click.BadParameter: there is none."""
    try:
        chosen = lazy.on_topic(books, topic)
    except LookupError as problem:
        raise click.BadParameter(str(problem.args[0]), param_hint="--topic") from None
    if not any(book.rules for book in chosen):
        names = ", ".join(book.name for book in books)
        raise click.BadParameter(f"{names}: no rule is on `{topic}`", param_hint="--topic")
    return chosen


def with_rules_like(rules: lazy.CompiledRulebook, patterns: Sequence[str]) -> lazy.CompiledRulebook:
    """A compiled rulebook with only the rules that match one of the patterns, if there are any."""
    if not patterns:
        return rules
    kept = [
        rule for rule in rules.rules if any(fnmatchcase(rule.name, pattern) for pattern in patterns)
    ]
    return replace(rules, rules=tuple(kept))
