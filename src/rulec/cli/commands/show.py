"""``rulec show``: a rule in English, by formula, automaton and examples."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

import rulec
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.shell_completion import complete_rules
from rulec.cli.output import put_answer, width_of
from rulec.diagnostics import named, nearest_name
from rulec.settings import search_path

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.report.automata.automaton_model import Automaton
    from rulec.rulebook.rulebook_model import Rule, Rulebook


@click.command()
@shared.rulebook_argument
@click.argument("rule", required=False, shell_complete=complete_rules)
@click.option(
    "--automaton",
    type=click.Choice(["text", "dot", "svg"]),
    help="The rule's automaton alone: as text, for Graphviz, or as a picture.",
)
@output_options(
    endings_of("text", "json", "dot", "svg"),
    "the rule: text, JSON, or its automaton for Graphviz or as a picture",
    alias="automaton",
)
@shared.at_option
def command(
    rulebook: str,
    rule: str | None,
    automaton: str | None,
    to: Output,
    at: str,
) -> None:
    """Show a RULE of a RULEBOOK: in plain English, as a formula, as an automaton, by examples.

    The sentence in English is made from the formula, and has one reading only. Without RULE every
    rule is shown in brief, a rulebook's only one in full.
    """
    # Rules and automata, 60 ms: not for --help.
    from rulec.report.rulebooks import rule_json, rule_page
    from rulec.report.rulebooks.spoken_rules import spoken_book

    is_automaton = automaton is not None or to.form in ("dot", "svg")
    book, compiled = _read(rulebook, at)
    chosen = _chosen(book, rule, rulebook)
    width = width_of(to)
    if chosen is None and is_automaton:
        raise click.UsageError(f"give the RULE whose automaton to show: {_names(book)}")
    page = None
    if chosen is not None:
        if compiled is None:
            compiled = rulec.compile_rulebook(replace(book, rules=(chosen,)))
        machine = next(rule for rule in compiled.rules if rule.name == chosen.name)
        page = rule_page.page_of(chosen, machine, compiled.vocabulary)
    spoken = spoken_book(book)
    rules = spoken.rules
    if chosen is not None and page is not None:
        rules = tuple(rule for rule in spoken.rules if rule.name == chosen.name)
        page = replace(page, rule=rules[0])
    if to.form == "json":
        text = rule_json.as_json(book.name, rules, book.vocabulary, page)
    elif page is None:
        text = "\n\n\n".join(
            rule_page.summary(rule, book.name, book.vocabulary, width) for rule in rules
        )
    elif not is_automaton:
        text = rule_page.as_text(page, book.name, book.vocabulary, width)
    else:
        name = f"{book.name} {page.rule.name}"
        text = _automaton(page.automaton, to.form, name, width)
    put_answer(text, to)


def _read(reference: str, at: str) -> tuple[Rulebook, CompiledRulebook | None]:
    # Rulebooks, 130 ms: not for --help.
    from rulec.automata.bundle.bundle_file import read_compiled
    from rulec.automata.bundle.compiled_rulebook import CompiledRule
    from rulec.automata.bundle.required_signature import refuse_source
    from rulec.rulebook.rulebook_model import Rule, Rulebook

    if Path(reference).suffix != ".json":
        refuse_source(reference)
        return rulec.Session(search_path(), at).load_rulebook(reference), None
    compiled = read_compiled(Path(reference))
    # What a compiled rule has besides is what it was compiled into.
    names = {field.name for field in fields(CompiledRule)} & {field.name for field in fields(Rule)}
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
