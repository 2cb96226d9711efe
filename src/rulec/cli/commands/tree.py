"""``rulec tree``: the inheritance of a rulebook's items, and which rulebooks extend which."""

from __future__ import annotations

import sys

import click

from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.verb_class import Verb
from rulec.cli.output import open_session, put_answer, sources_of_rulebooks, width_of
from rulec.diagnostics import named
from rulec.report.text.terminal_text import wants_color
from rulec.settings import search_path


@click.command(cls=Verb)
@shared.rulebooks_argument("[RULEBOOK...]", required=False)
@shared.rules_option("Show only rules that match PATTERN")
@output_options(endings_of("text", "json"), "the tree")
@shared.at_option
def command(rulebooks: tuple[str, ...], patterns: tuple[str, ...], to: Output, at: str) -> None:
    """Show what a RULEBOOK inherits, overrides, softens and drops, and from which book.

    RULEBOOK is a name or the path of a source. With several RULEBOOKs, or none for all available
    ones, show which one extends which.
    """
    # Late import, not for --help: rulebooks and their colours (80 ms).
    from rulec.analysis.lineage.book_lineage import book_header
    from rulec.analysis.lineage.rule_lineage import extension_forest
    from rulec.report.rulebooks import lineage_tree
    from rulec.rulebook.files.catalogue import rulebook_heads

    rulebooks = sources_of_rulebooks(rulebooks, "cannot be taken apart")
    width, color = width_of(to), wants_color(sys.stdout)
    if len(rulebooks) == 1:
        inherited = lineage_tree.chosen(open_session(at).tree(rulebooks[0]), patterns)
        if patterns and not inherited.rules:
            raise click.UsageError(f"{inherited.book} has no rule like {named(patterns)}")
        shown = lineage_tree.as_json(inherited)
        if to.form == "text":
            shown = lineage_tree.as_text(inherited, width, color=color)
    else:
        if patterns:
            raise click.UsageError("--rule chooses among the rules of one RULEBOOK; give one")
        session = open_session(at)
        if rulebooks:
            books = [book for name in rulebooks for book in session.tree(name).books]
        else:
            books = [book_header(tree) for tree in rulebook_heads(search_path())]
        branches = extension_forest(books)
        shown = lineage_tree.forest_as_json(branches)
        if to.form == "text":
            shown = lineage_tree.forest_as_text(branches, width, color=color)
    put_answer(shown, to)
