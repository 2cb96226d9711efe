"""The rules that `--rule PATTERN` chooses from rulebooks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

import click

from rulec.diagnostics import did_you_mean

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.rulebook.rulebook_model import Rulebook


def refuse_unmatched(
    patterns: Sequence[str], books: Sequence[Rulebook] | Sequence[CompiledRulebook]
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


def rules_on_topic(books: Sequence[Rulebook], topic: str) -> tuple[Rulebook, ...]:
    """The rulebooks with only their rules on a topic. Raises click.BadParameter: there is none."""
    # Late import, only if a topic is given: the phrases of vocabularies (10 ms).
    from rulec.rulebook.rules.rule_topics import on_topic

    try:
        chosen = on_topic(books, topic)
    except LookupError as problem:
        raise click.BadParameter(str(problem.args[0]), param_hint="--topic") from None
    if not any(book.rules for book in chosen):
        names = ", ".join(book.name for book in books)
        raise click.BadParameter(f"{names}: no rule is on `{topic}`", param_hint="--topic")
    return chosen


def with_rules_like(rules: CompiledRulebook, patterns: Sequence[str]) -> CompiledRulebook:
    """A compiled rulebook with only the rules that match one of the patterns, if there are any."""
    if not patterns:
        return rules
    kept = [
        rule for rule in rules.rules if any(fnmatchcase(rule.name, pattern) for pattern in patterns)
    ]
    return replace(rules, rules=tuple(kept))
