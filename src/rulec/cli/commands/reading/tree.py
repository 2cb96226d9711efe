"""``rulec show --tree``: what a rulebook inherits, and which rulebooks extend which."""

from __future__ import annotations

import sys
from collections.abc import Iterable

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.verb_class import option, verb
from rulec.cli.output import open_session, put_answer, sources_of_rulebooks, width_of
from rulec.diagnostics import named
from rulec.report.findings.diagnostics_text import print_diagnostics
from rulec.report.text.terminal_text import wants_color
from rulec.rulebook.batch.answer_cache import AnswerQuestion
from rulec.settings import search_path


@verb
def command(
    *,
    rulebooks: tuple[str, ...] = shared.rulebooks_argument("[RULEBOOK...]", required=False),
    patterns: tuple[str, ...] = shared.rules_option("Show only rules that match PATTERN"),
    every: bool = option(
        "--all", is_flag=True, help="Show the history of all rules and of what can be set."
    ),
    to: Output = output_options(endings_of("text", "json"), "the tree"),
    at: str = shared.at_option,
) -> None:
    """Show what a RULEBOOK overrides, softens and drops, has of its own, and only inherits.

    RULEBOOK is a name or the path of a source. The histories of all rules, or of those that match
    --rule, are shown with --all. With several RULEBOOKs, or none for all available ones, show
    which one extends which.
    """
    rulebooks = sources_of_rulebooks(rulebooks, "cannot be taken apart")
    if patterns and len(rulebooks) != 1:
        raise click.UsageError("--rule chooses among the rules of one RULEBOOK; give one")
    width, color = width_of(to), wants_color(sys.stdout)
    words = ("tree", *rulebooks, repr((patterns, every, to.form, width, color, at)))

    def made() -> tuple[str, Iterable[str]]:
        """What to show, and its sources; none with warnings, or of several rulebooks."""
        if len(rulebooks) == 1:
            loaded, lineage, _ = lazy.read_with_lineage(rulebooks[0], search_path(), at)
            if loaded.warnings:
                print_diagnostics(loaded.warnings)
            inherited = lazy.lineage_tree.chosen(lineage, patterns)
            if patterns and not inherited.rules:
                raise click.UsageError(f"{inherited.book} has no rule like {named(patterns)}")
            sources = () if loaded.warnings else loaded.sources
            if to.form == "text" and not every and not patterns:
                return lazy.lineage_tree.as_overview(inherited, width), sources
            if to.form == "text":
                return lazy.lineage_tree.as_text(inherited, width, color=color), sources
            return lazy.lineage_tree.as_json(inherited), sources
        session = open_session(at)
        if rulebooks:
            books = [book for name in rulebooks for book in session.tree(name).books]
        else:
            books = [lazy.book_header(tree) for tree in lazy.rulebook_heads(search_path())]
        branches = lazy.extension_forest(books)
        if to.form == "text":
            return lazy.lineage_tree.forest_as_text(branches, width, color=color), ()
        return lazy.lineage_tree.forest_as_json(branches), ()

    put_answer(AnswerQuestion(words, search_path()).answer(made), to)
