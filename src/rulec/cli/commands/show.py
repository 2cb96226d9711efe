"""``rulec show``: a rule in English, by formula, automaton and examples."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

import rulec
from rulec.cli.options import shared_options as shared
from rulec.cli.options.shell_completion import complete_rules
from rulec.diagnostics import named, nearest_name
from rulec.report.text.console import PAGE_WIDTH, page_width, put_result
from rulec.settings import search_path

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.report.automata.automaton_model import Automaton
    from rulec.rulebook.rulebook_model import Rule, Rulebook

SUFFIXES = {".dot": "dot", ".gv": "dot", ".svg": "svg"}

OTHERS = (".pdf", ".png", ".jpg", ".jpeg")
"""Ends of names of pictures that are not drawn."""


@click.command()
@shared.rulebook_argument
@click.argument("rule", required=False, shell_complete=complete_rules)
@click.option(
    "--automaton",
    "automaton_format",
    type=click.Choice(["text", "dot", "svg"]),
    help="The rule's automaton alone: as text, for Graphviz, or as a picture.",
)
@shared.text_output_option(
    "Write to FILE. One that ends in .svg, .dot or .gv gets the automaton in that format.",
)
@shared.json_option
@shared.at_option
def command(
    rulebook: str,
    rule: str | None,
    automaton_format: str | None,
    output: str | None,
    json_output: bool,
    at: str,
) -> None:
    """Show a RULE of a RULEBOOK: in plain English, as a formula, as an automaton, by examples.

    The sentence in English is made from the formula, and has one reading only. Without RULE every
    rule is shown in brief, a rulebook's only one in full.
    """
    # Rules and automata, 60 ms: not for --help.
    from rulec.report.rulebooks import rule_json, rule_page

    if output is not None and automaton_format is None and not json_output:
        if Path(output).suffix.lower() in OTHERS:
            raise click.UsageError(f"{output}: an automaton is drawn in a file .svg, .dot or .gv")
        automaton_format = SUFFIXES.get(Path(output).suffix)
    if json_output and automaton_format is not None:
        raise click.UsageError("give --json or --automaton; the JSON has the automaton in it")
    book, compiled = _read(rulebook, at)
    chosen = _chosen(book, rule, rulebook)
    width = page_width() if output is None else PAGE_WIDTH
    if chosen is None and automaton_format is not None:
        raise click.UsageError(f"give the RULE whose automaton to show: {_names(book)}")
    page = None
    if chosen is not None:
        if compiled is None:
            compiled = rulec.compile_rulebook(replace(book, rules=(chosen,)))
        machine = next(rule for rule in compiled.rules if rule.name == chosen.name)
        page = rule_page.page_of(chosen, machine, compiled.vocabulary)
    rules = book.rules if chosen is None else (chosen,)
    if json_output:
        text = rule_json.as_json(book.name, rules, book.vocabulary, page)
    elif page is None:
        text = "\n\n\n".join(
            rule_page.summary(rule, book.name, book.vocabulary, width) for rule in rules
        )
    elif automaton_format is None:
        text = rule_page.as_text(page, book.name, book.vocabulary, width)
    else:
        name = f"{book.name} {page.rule.name}"
        text = _automaton(page.automaton, automaton_format, name, width)
    put_result(text, output)


def _read(reference: str, at: str) -> tuple[Rulebook, CompiledRulebook | None]:
    # Rulebooks, 130 ms: not for --help.
    from rulec.automata.bundle.bundle_file import read_compiled
    from rulec.automata.bundle.compiled_rulebook import CompiledRule
    from rulec.rulebook.rulebook_model import Rule, Rulebook

    if Path(reference).suffix != ".json":
        return rulec.Session(search_path(), at).load_rulebook(reference), None
    compiled = read_compiled(Path(reference))
    # What a compiled rule has besides is its automaton, and the one step that this is for.
    names = {field.name for field in fields(CompiledRule)} - {"machine", "hoa", "step_s"}
    rules = [Rule(**{name: getattr(rule, name) for name in names}) for rule in compiled.rules]
    in_books = tuple(replace(rule, book=rule.book or compiled.name) for rule in rules)
    return Rulebook(compiled.name, compiled.vocabulary, in_books), compiled


def _chosen(book: Rulebook, name: str | None, reference: str) -> Rule | None:
    if name is None:
        return book.rules[0] if len(book.rules) == 1 else None
    by_name = {rule.name: rule for rule in book.rules}
    if name not in by_name:
        if why := _why_absent(book, name, reference):
            raise click.UsageError(f"{book.name} has no rule `{name}`{why}")
        near = nearest_name(name, by_name)
        way_out = f"did you mean `{near}`?" if near else f"it has {_names(book)}"
        raise click.UsageError(f"{book.name} has no rule `{name}`; {way_out}")
    return by_name[name]


def _why_absent(book: Rulebook, name: str, reference: str) -> str:
    # Only for this message: the printer of rulebooks, 60 ms.
    from rulec.syntax.tree_printer import print_in_force

    if Path(reference).suffix == ".json":
        return ""
    inherited = rulec.Session(search_path(), book.at).tree(reference)
    last = next((rule.steps[-1] for rule in inherited.rules if rule.name == name), None)
    if last is None:
        return ""
    if last.rule is not None and last.rule.in_force is not None:
        return f" on {book.at}: it is {print_in_force(last.rule.in_force)}"
    deed = {"dropped": "dropped it", "silent": "is silent on it"}[last.deed]
    return f": {last.book} {deed}, because {last.because}"


def _names(book: Rulebook) -> str:
    return named([rule.name for rule in book.rules])


def _automaton(automaton: Automaton, output_format: str, name: str, width: int) -> str:
    # Pictures of automata, 40 ms: only with --automaton.
    from rulec.report.automata.automaton_layout import is_too_large
    from rulec.report.automata.automaton_picture import as_picture
    from rulec.report.automata.automaton_text import as_dot, as_text
    from rulec.report.pictures.drawing.picture_formats import as_svg

    if output_format == "text":
        return as_text(automaton, width)
    if output_format == "dot":
        return as_dot(automaton, name)
    if is_too_large(automaton):
        raise click.ClickException(
            f"an automaton of {len(automaton.fates):,} states and {len(automaton.transitions):,} "
            "transitions is too large to draw; see it with --automaton text, or lay it out "
            "yourself from --automaton dot"
        )
    return as_svg(as_picture(automaton, name))
