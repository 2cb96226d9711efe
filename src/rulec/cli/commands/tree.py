"""``rulec tree``: what a rulebook inherits, overrides and drops, and who extends whom."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from rulec.cli.options.shared_options import at_option, json_option, only_sources
from rulec.cli.options.shell_completion import complete_rulebooks

if TYPE_CHECKING:
    from rulec.analysis.lineage.rule_lineage import BookHeader, BookLineage


@click.command()
@click.argument("rulebooks", nargs=-1, metavar="[RULEBOOK...]", shell_complete=complete_rulebooks)
@click.option(
    "--rule",
    "pattern",
    metavar="PATTERN",
    help="Show only the rules whose name this matches; * and ? are wild.",
)
@json_option
@at_option
def command(rulebooks: tuple[str, ...], pattern: str | None, json_output: bool, at: str) -> None:
    """Show what a RULEBOOK inherits, overrides, softens and drops, and which book set what.

    It is given by its name or the path of its source. Of several RULEBOOKs, or without any of all
    that there are, it shows which one extends which.
    """
    from rulec.analysis.lineage.extension_forest import extension_forest
    from rulec.report.rulebooks import lineage_tree
    from rulec.report.text.console import page_width, print_result, wants_color

    only_sources(rulebooks, "be taken apart")
    width, color = page_width(), wants_color(sys.stdout)
    if len(rulebooks) == 1:
        inherited = lineage_tree.chosen(_inheritance(rulebooks[0], at), pattern)
        if pattern is not None and not inherited.rules:
            raise click.UsageError(f"{inherited.book} has no rule like `{pattern}`")
        shown = lineage_tree.as_json(inherited)
        if not json_output:
            shown = lineage_tree.as_text(inherited, width, color=color)
    else:
        if pattern is not None:
            raise click.UsageError("--rule chooses among the rules of one RULEBOOK; give one")
        branches = extension_forest(_members(rulebooks, at))
        shown = lineage_tree.forest_as_json(branches)
        if not json_output:
            shown = lineage_tree.forest_as_text(branches, width, color=color)
    print_result(shown)


def _inheritance(rulebook: str, at: str) -> BookLineage:
    from rulec.analysis.lineage.book_lineage import read_with_lineage
    from rulec.settings import search_path

    return read_with_lineage(rulebook, search_path(), at)[1]


def _members(rulebooks: tuple[str, ...], at: str) -> list[BookHeader]:
    """The rulebooks and all that they extend; without any, all that can be asked for by name."""
    from rulec.analysis.lineage.book_lineage import book_header
    from rulec.rulebook.files.catalogue import rulebook_trees
    from rulec.settings import search_path

    if not rulebooks:
        return [book_header(one) for one in rulebook_trees(search_path())]
    return [book for one in rulebooks for book in _inheritance(one, at).books]
