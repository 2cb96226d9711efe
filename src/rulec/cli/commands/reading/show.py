"""``rulec show``: a rule in English, by formula, automaton and examples."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path

import click

import rulec
from rulec.automata.bundle.required_signature import refuse_source
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.shared_options import rules_on_topic
from rulec.cli.options.shell_completion import complete_rules
from rulec.cli.options.verb_class import argument, gathered, option, verb
from rulec.cli.output import books_and_rule, errors_told, put_answer, rulebooks_named, width_of
from rulec.diagnostics import first_of, named, nearest_name
from rulec.report.text.console import print_remark
from rulec.rulebook.batch.answer_cache import AnswerQuestion
from rulec.settings import search_path

_MOST_NAMED = 6
"""The most rules listed where one has to be chosen."""


@dataclass(frozen=True, kw_only=True)
class ShowOptions:
    """The rules to show, and how."""

    rulebook: str = shared.rulebook_argument
    others: tuple[str, ...] = argument(
        nargs=-1, metavar="[RULEBOOK...] [RULE]", shell_complete=complete_rules
    )
    automaton: str | None = option(
        "--automaton",
        type=click.Choice(["text", "dot", "svg"]),
        help="Show only the rule's automaton: as text, for Graphviz, or as a picture.",
    )
    to: Output = output_options(
        endings_of("text", "json", "dot", "svg"),
        "the rule: text, JSON, or its automaton for Graphviz or as a picture",
        alias="automaton",
    )
    patterns: tuple[str, ...] = shared.rules_option("Show only rules that match PATTERN")
    topic: str | None = shared.topic_option("Show only rules on a topic")
    every: bool = option(
        "--all", is_flag=True, help="Show every rule in plain English, not a list."
    )
    at: str = shared.at_option


@verb
def command(*, asked: ShowOptions = gathered(ShowOptions)) -> int:
    """Show a RULE of a RULEBOOK: in plain English, as a formula, as an automaton, with examples.

    The English sentence is generated from the formula and is unambiguous. Without RULE every rule
    has a line, by topic; the only rule of a rulebook, or the only one that matches --rule or
    --topic, is shown in full. With several RULEBOOKs, folders or patterns, the RULE is shown for
    each; JSON has one line each.
    """
    to, rule = asked.to, None
    if asked.patterns:
        books = rulebooks_named((asked.rulebook, *asked.others))
    else:
        books, rule = books_and_rule((asked.rulebook, *asked.others), "show")
    if asked.automaton is not None or to.form in ("dot", "svg"):
        if len(books) > 1:
            raise click.UsageError("an automaton is of one rule; give one RULEBOOK")
        put_answer(_automaton_of(books[0], rule, asked), to)
        return ExitStatus.OK
    if len(books) == 1:
        put_answer(_known(books[0], rule, asked, several=False), to)
        return ExitStatus.OK
    shown: list[str] = []
    missing: list[click.UsageError] = []
    for book in books:
        with errors_told(), _collected(missing):
            text = _known(book, rule, asked, several=True)
            alone = to.form == "json" or (rule is None and not asked.every)
            shown.append(text if alone else f"{book}\n\n{text}\n")
    if missing and not shown:
        raise missing[0]
    put_answer("\n".join(shown), to)
    for problem in missing:
        print_remark(f"rulec: {problem.format_message()}")
    # That a rulebook has no such rule is also an answer.
    return ExitStatus.after(answered=len(shown) + len(missing) == len(books), failed=False)


@contextmanager
def _collected(problems: list[click.UsageError]) -> Iterator[None]:
    try:
        yield
    except click.UsageError as problem:
        problems.append(problem)


def _known(reference: str, name: str | None, request: ShowOptions, *, several: bool) -> str:
    """A rule as text or JSON, or all that match in brief; one JSON line each if ``several``."""
    shown = partial(_shown, reference, name, request, several=several)
    if Path(reference).suffix == ".json":
        return shown()[0]
    refuse_source(reference)
    same = replace(request, rulebook="", others=(), to=Output("", request.to.form))
    words = ("show", reference, repr((name, same, width_of(request.to), several)))
    return str(AnswerQuestion(words, search_path()).answer(shown))


def _shown(
    reference: str, name: str | None, request: ShowOptions, *, several: bool
) -> tuple[str, Sequence[str]]:
    """What to show, and the files that it comes from; none for a compiled rulebook."""
    whole, compiled, paths = _read(reference, request.at)
    book = _matching(whole, request)
    chosen = _chosen(book, name, reference)
    if book.rules and chosen is None and request.to.form == "text" and not request.every:
        some = "" if request.topic or not book.topics else ", `--topic overtaking` some"
        ways_on = f"a RULE's name shows it in full{some}, `--all` every one"
        return lazy.rule_list.as_text([book], width_of(request.to), ways_on), paths
    page = None if chosen is None else _page(book, compiled, chosen)
    rules = book.rules if chosen is None else (chosen,)
    if request.to.form == "json":
        document = lazy.rule_page.as_document(book, rules, page)
        return lazy.json_document.as_line(document) if several else lazy.json_document.as_indented(
            document
        ), paths
    width = width_of(request.to)
    if page is not None:
        return lazy.rule_page.as_text(page, book, width), paths
    if not rules:
        return f"{book.name} has no rules; `rulec explain NAME` explains what it defines", paths
    pages = [lazy.rule_page.summary(rule, book, width) for rule in rules]
    return "\n\n\n".join(pages), paths


def _matching(book: lazy.Rulebook, request: ShowOptions) -> lazy.Rulebook:
    """The rulebook with only the rules on the topic that match one of the patterns, if any."""
    if request.topic is not None:
        book = rules_on_topic([book], request.topic)[0]
    if not request.patterns:
        return book
    rules = tuple(lazy.rules_matching(book, request.patterns).values())
    if not rules:
        raise click.UsageError(f"{book.name} has no rule like {named(request.patterns)}")
    return replace(book, rules=rules)


def _automaton_of(reference: str, name: str | None, request: ShowOptions) -> str:
    """The automaton of a rule, in the requested format."""
    whole, compiled, _ = _read(reference, request.at)
    book = _matching(whole, request)
    chosen = _chosen(book, name, reference)
    if chosen is None:
        raise click.UsageError(f"give the RULE whose automaton to show: {_names(book)}")
    page = _page(book, compiled, chosen)
    title = f"{book.name} {chosen.name}"
    return _automaton(page.automaton, request.to.form, title, width_of(request.to))


def _page(
    book: lazy.Rulebook, compiled: lazy.CompiledRulebook | None, chosen: lazy.Rule
) -> lazy.RulePage:
    """All data about a rule for display."""
    if compiled is None:
        compiled = rulec.compile_rulebook(replace(book, rules=(chosen,)))
    return lazy.page_of(chosen, compiled)


def _read(
    reference: str, at: str
) -> tuple[lazy.Rulebook, lazy.CompiledRulebook | None, Sequence[str]]:
    """A rulebook, in its compiled form if it is, and the files of its source."""
    if Path(reference).suffix != ".json":
        refuse_source(reference)
        loaded = lazy.read_rulebook(reference, search_path(), at)
        return loaded.rulebook, None, [*loaded.sources]
    compiled = lazy.read_compiled(Path(reference), at)
    # The other fields of a compiled rule are its compiled form.
    names = {field.name for field in fields(lazy.CompiledRule)} & {
        field.name for field in fields(lazy.Rule)
    }
    rules = [lazy.Rule(**{name: getattr(rule, name) for name in names}) for rule in compiled.rules]
    in_books = tuple(replace(rule, book=rule.book or compiled.name) for rule in rules)
    about = {name: getattr(compiled, name) for name in ("title", "law", "as_of")}
    return lazy.Rulebook(compiled.name, compiled.vocabulary, in_books, **about), compiled, ()


def _chosen(book: lazy.Rulebook, name: str | None, reference: str) -> lazy.Rule | None:
    if name is None:
        return book.rules[0] if len(book.rules) == 1 else None
    by_name = {rule.name: rule for rule in book.rules}
    if name not in by_name:
        if why := _why_absent(book, name, reference):
            raise click.UsageError(f"{book.name} has no rule `{name}`{why}")
        raise click.UsageError(f"{book.name} has no rule `{name}`; {_way_out(book, name)}")
    return by_name[name]


def _way_out(book: lazy.Rulebook, name: str) -> str:
    """A suggestion of the rule that may be meant, here or in another rulebook."""
    if near := nearest_name(name, {rule.name for rule in book.rules}):
        return f"did you mean `{near}`?"
    if name in {*book.vocabulary.declarations, *book.vocabulary.enumeration_of}:
        return f"it is a word that rules read, which `rulec explain {name}` explains"
    if any(name in names for names in lazy.definitions_of_rulebooks(search_path()).values()):
        return f"it is a definition or a parameter, which `rulec explain {name}` explains"
    words = {*name.casefold().split("_")}
    if longer := [f"`{rule.name}`" for rule in book.rules if words < {*rule.name.split("_")}]:
        return f"it has {first_of(longer, _MOST_NAMED)}"
    if others := lazy.rulebooks_with_rule(name, search_path()):
        return f"there is one in {first_of(others, _MOST_NAMED)}"
    return f"it has {_names(book)}" if book.rules else "it has no rules"


def _why_absent(book: lazy.Rulebook, name: str, reference: str) -> str:
    if Path(reference).suffix == ".json":
        return ""
    inherited = rulec.Session(search_path(), book.at).tree(reference)
    last = next((rule.steps[-1] for rule in inherited.rules if rule.name == name), None)
    if last is None:
        return ""
    if last.rule is not None and last.rule.in_force is not None:
        return f" on {book.at}: it is {lazy.print_in_force(last.rule.in_force)}"
    deed = {"dropped": "dropped it", "silent": "is silent on it"}[last.deed]
    return f": {last.book} {deed}, because {last.because}"


def _names(book: lazy.Rulebook) -> str:
    names = [f"`{rule.name}`" for rule in book.rules]
    more = f"; `rulec show {book.name}` shows all" if len(names) > _MOST_NAMED else ""
    return f"{first_of(names, _MOST_NAMED)}{more}"


def _automaton(automaton: lazy.Automaton, output_format: str, name: str, width: int) -> str:
    if output_format == "text":
        return lazy.automaton_model.as_text(automaton, width)
    if output_format == "dot":
        return lazy.automaton_model.as_dot(automaton, name)
    if lazy.is_too_large(automaton):
        raise click.ClickException(
            f"an automaton of {len(automaton.fates):,} states and {len(automaton.transitions):,} "
            "transitions is too large to draw; see it with --automaton text, or lay it out "
            "yourself from --automaton dot"
        )
    return lazy.picture_formats.as_svg(lazy.automaton_picture.as_picture(automaton, name))
