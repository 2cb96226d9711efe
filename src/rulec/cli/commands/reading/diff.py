"""``rulec diff``: how two rulebooks differ."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import NamedTuple

import click

import rulec
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.shared_options import refuse_unmatched, rules_on_topic
from rulec.cli.options.verb_class import option, verb
from rulec.cli.output import (
    answer_lines,
    books_and_rule,
    errors_told,
    output_stream,
    print_written,
    put_answer,
    sources_of_rulebooks,
    width_of,
)
from rulec.diagnostics import Diagnostic, did_you_mean
from rulec.report.findings.diagnostics_text import print_diagnostics
from rulec.report.text.console import print_remark, progress
from rulec.report.text.terminal_text import counted, wants_color
from rulec.rulebook.batch.answer_cache import AnswerQuestion
from rulec.rulebook.files.search_path import available_rulebooks
from rulec.settings import search_path


@verb
def command(
    *,
    rulebooks: tuple[str, ...] = shared.rulebooks_argument("RULEBOOK... [RULE]", required=False),
    every: bool = option(
        "--all",
        is_flag=True,
        help="Compare every pair of the named rulebooks, or of all available ones.",
    ),
    patterns: tuple[str, ...] = shared.rules_option("Compare only rules that match PATTERN"),
    topic: str | None = shared.topic_option("Show what any number of RULEBOOKs say on a topic"),
    verbose: bool = option(
        "-v",
        "--verbose",
        is_flag=True,
        help="Show traces of every rule, and all sentences of a topic.",
    ),
    paired: tuple[str, ...] = option(
        "--pair",
        multiple=True,
        metavar="A=B",
        help="Compare rule A of the first with rule B of the second. May be given several times.",
    ),
    step_s: Fraction | None = shared.step_option(
        "The time step, in s, on which rules with bounds in seconds are compared.  [default: one "
        "that divides the steps of their examples]",
    ),
    n_witnesses: int = shared.number_option(
        "--witnesses",
        "Show up to N traces for every difference, each for a different reason.",
        least=1,
        most=100,
        default=3,
    ),
    to: Output = output_options(
        endings_of("text", "markdown", "json", "html", "csv"),
        "the comparison: text, Markdown, JSON, an HTML page, or CSV with a row per rule",
    ),
    witness: str | None = option(
        "--witness",
        type=click.Path(dir_okay=False, allow_dash=True),
        metavar="FILE",
        help="Write the traces that one rulebook forbids and the other allows to FILE, as JSON "
        "Lines.",
    ),
    at: str = shared.no_cache_and(shared.at_option),
) -> int:
    """Compare two RULEBOOKs: which rules of the first are stricter or laxer than the second's.

    Both are names or paths of sources. Every rule that differs has a line; for a RULE, or one of
    --rule or --pair, short traces show it that one rulebook forbids and the other allows. With
    --topic, any number of rulebooks are laid side by side in their own words; with --all, each is
    compared with each in an overview.

    Exit status: 0 no difference, 1 differences found, 2 a question could not be answered; with
    --topic 0.
    """
    if len(rulebooks) > 2 and not every and topic is None:
        rulebooks, rule = books_and_rule(rulebooks, "diff")
        patterns = patterns if rule is None else (*patterns, rule)
    rulebooks = sources_of_rulebooks(rulebooks, "cannot be compared")
    if topic is not None:
        if every or paired or patterns or witness is not None or len(rulebooks) < 2:
            raise click.UsageError(
                "--topic lays the words of two or more rulebooks side by side, without --rule, "
                "--pair, --all and --witness"
            )
        width = width_of(to)
        asked = ("diff", "on", topic, at, str((to.form, width, verbose)), *rulebooks)
        question = AnswerQuestion(asked, search_path())
        on_topic = partial(_on_topic, rulebooks, (topic, at), to, in_full=verbose)
        put_answer(question.answer(on_topic), to)
        return ExitStatus.OK
    if every:
        if paired:
            raise click.UsageError("--pair is for two rulebooks, not for --all")
        if witness is not None:
            raise click.UsageError("--witness is for two rulebooks, not for --all")
        pairs = AllPairs(tuple(patterns), step_s, at, to.form, width_of(to))
        return _compared(rulebooks, pairs, to)
    if len(rulebooks) != 2:
        books = " ".join(rulebooks)
        raise click.UsageError(
            f"it compares two rulebooks; for {len(rulebooks)}, use `rulec diff --all {books}`, or "
            f"`rulec diff {books} --topic overtaking`"
            if len(rulebooks) > 2
            else f"with which rulebook is it to be compared? As in `rulec diff {books or 'de'} nl`"
        )
    two = TwoBooks(patterns, paired, step_s, n_witnesses)
    in_full = verbose or bool(patterns or paired)
    shown = (to.form, width_of(to), in_full, wants_color(sys.stdout))
    question_words = ("diff", at, *map(str, (*two, *shown)), *rulebooks)
    question = AnswerQuestion(question_words, search_path())
    known = question.recall() if witness is None else None
    if known is None:
        warned: list[Diagnostic] = []
        difference = _difference(rulebooks, two, at, warned)
        if witness is not None:
            _write_witnesses(difference, witness)
        text = lazy.diff_formats.render(difference, to.form, width_of(to), in_full=in_full)
        known = text, difference.is_complete, difference.is_none
        if difference.is_complete and not warned:
            question.remember(known, difference.files)
    text, is_complete, is_none = known
    put_answer(text, to)
    return ExitStatus.after(answered=is_complete, failed=not is_none)


def _difference(
    rulebooks: Sequence[str],
    question: TwoBooks,
    at: str,
    warned: list[Diagnostic],
) -> lazy.RulebookDiff:
    """The differences of two rulebooks; their warnings are printed, and added to ``warned``."""

    def warn(diagnostics: Sequence[Diagnostic]) -> None:
        print_diagnostics(diagnostics)
        warned.extend(diagnostics)

    named = []
    if question.paired or question.patterns:
        named = [lazy.load_rulebook(name, search_path(), at) for name in rulebooks]
        refuse_unmatched(question.patterns, named)
    with progress("comparing", None) as tell:
        first, second = rulebooks
        return rulec.Session(search_path(), at, warn).diff(
            first,
            second,
            patterns=question.patterns,
            step_s=question.step_s,
            witnesses=question.n_witnesses,
            paired=_pairs(question.paired, named),
            on_progress=tell,
        )


def _on_topic(
    rulebooks: Sequence[str], about: tuple[str, str], to: Output, *, in_full: bool
) -> tuple[str, Sequence[str]]:
    """What rulebooks say on a topic, by the law of a day, and the files that were read."""
    topic, at = about
    read = [lazy.read_rulebook(name, search_path(), at) for name in rulebooks]
    books = rules_on_topic([loaded.rulebook for loaded in read], topic)
    text = lazy.topic_report.render(books, topic, to.form, width_of(to), in_full=in_full)
    return text, [path for loaded in read for path in loaded.sources]


def _write_witnesses(difference: lazy.RulebookDiff, path: str) -> None:
    with output_stream(Output(path, "jsonl")) as (stream, name):
        number = lazy.json_lines.write_traces(difference.witnesses, stream)
    print_remark(f"wrote {counted(number, 'trace')} to {name}")


class TwoBooks(NamedTuple):
    """The request for a comparison of two rulebooks."""

    patterns: tuple[str, ...]
    paired: tuple[str, ...]
    step_s: Fraction | None
    n_witnesses: int


class AllPairs(NamedTuple):
    """The request for an overview of many rulebooks."""

    patterns: tuple[str, ...]
    step_s: Fraction | None
    at: str
    form: str
    width: int


def _compared(rulebooks: Sequence[str], pairs: AllPairs, to: Output) -> int:
    """Write the overview of these rulebooks, or of all, and return the status."""
    folders = search_path()
    names = list(dict.fromkeys(rulebooks or available_rulebooks(folders)))
    every = "" if rulebooks else "all"
    question = AnswerQuestion(("diff", every, *map(str, pairs), "", *names), folders)
    known = question.recall()
    if known is None:
        with answer_lines(to) as write:
            text, alone, is_complete, is_uniform, paths = _matrix(
                names, pairs, write, is_all=not rulebooks
            )
        known = text, alone, is_complete, is_uniform
        if is_complete:
            question.remember(known, paths)
        print_written(to.path, to)
    else:
        put_answer(known[0], to)
    text, alone, is_complete, is_uniform = known
    if alone:
        print_remark(f"left out, because they share no rule with others: {', '.join(alone)}")
    if not text:
        print_remark("there are no two rulebooks to compare")
        return ExitStatus.NOT_ANSWERED
    return ExitStatus.after(answered=is_complete, failed=not is_uniform)


def _matrix(
    names: Sequence[str], pairs: AllPairs, write: Callable[[str], object], *, is_all: bool
) -> tuple[str, tuple[str, ...], bool, bool, list[str]]:
    """The overview, the rulebooks left out, whether it is complete and uniform, and the files read.

    It is written as it is made; for fewer than two rulebooks it is empty.
    """
    paths: list[str] = []
    parts: list[str] = []

    def books() -> Iterator[lazy.Rulebook]:
        # Treaties before the rulebooks that extend them, so that the treaty is law A.
        for reference, name in lazy.named_by_heads(names, search_path()).items():
            loaded = None
            with errors_told():
                loaded = lazy.read_rulebook(reference, search_path(), pairs.at)
            if loaded is not None:
                paths.extend(loaded.sources)
                yield replace(loaded.rulebook, name=name)

    def put(text: str) -> None:
        if text:
            parts.append(text)
            write(text)

    matrix = lazy.ComparisonMatrix((), ())
    with progress("comparing", len(names)) as tell:
        for matrix in lazy.growing_matrices(books(), pairs.patterns, pairs.step_s):
            tell(len(matrix.books))
            lines = lazy.matrix_report.last_pairs(matrix, pairs.form, pairs.width)
            if lines and not parts:
                put(lazy.matrix_report.opening(pairs.form, pairs.width))
            put("\n".join(lines))
    refuse_unmatched(pairs.patterns, matrix.books)
    is_read = len(matrix.books) == len(names)
    uses = Counter(rule.name for book in matrix.books for rule in book.rules)
    alone = tuple(
        book.name
        for book in matrix.books
        if is_all and all(uses[rule.name] == 1 for rule in book.rules)
    )
    matrix = matrix.without(alone)
    if len(matrix.books) > 1:
        put(lazy.matrix_report.render(matrix, pairs.form, pairs.width))
    is_complete = is_read and matrix.is_complete
    return "\n".join(parts), alone, is_complete, matrix.is_uniform, paths


def _pairs(texts: Sequence[str], books: Sequence[lazy.Rulebook]) -> dict[str, str]:
    """Pairs of rule names from texts ``A=B``: a rule of the first, one of the second rulebook."""
    pairs: dict[str, str] = {}
    for text in texts:
        names = tuple(name.strip() for name in text.split("="))
        if len(names) != 2:
            raise click.BadParameter(f"`{text}` is no pair such as `A=B`", param_hint="--pair")
        for name, book in zip(names, books, strict=True):
            known = [rule.name for rule in book.rules]
            if name not in known:
                near = did_you_mean(name, known)
                raise click.BadParameter(
                    f"{book.name} has no rule `{name}`{near and f'; {near}'}", param_hint="--pair"
                )
        if names[0] in pairs or names[1] in pairs.values():
            raise click.BadParameter(f"a rule of `{text}` has a pair already", param_hint="--pair")
        pairs[names[0]] = names[1]
    return pairs
