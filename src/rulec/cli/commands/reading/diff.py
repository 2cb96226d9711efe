"""``rulec diff``: how two rulebooks differ."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

import click

import rulec
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.shared_options import refuse_unmatched, rules_on_topic
from rulec.cli.options.verb_class import gathered, option, verb
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


@dataclass(frozen=True, kw_only=True)
class DiffOptions:
    """How rulebooks are compared, and what is said of them."""

    every: bool = option(
        "--all",
        is_flag=True,
        help="Compare every pair of the named rulebooks, or of all available ones.",
    )
    patterns: tuple[str, ...] = shared.rules_option("Compare only rules that match PATTERN")
    topic: str | None = shared.topic_option("Show what any number of RULEBOOKs say on a topic")
    verbose: bool = option(
        "-v",
        "--verbose",
        is_flag=True,
        help="Show traces of every rule, and all sentences of a topic.",
    )
    paired: tuple[str, ...] = option(
        "--pair",
        multiple=True,
        metavar="A=B",
        help="Compare rule A of the first with rule B of the second. May be given several times.",
    )
    step_s: Fraction | None = shared.step_option(
        "The time step, in s, on which rules with bounds in seconds are compared.  [default: one "
        "that divides the steps of their examples]",
    )
    n_witnesses: int = shared.number_option(
        "--witnesses",
        "Show up to N traces for every difference, each for a different reason.",
        least=1,
        most=100,
        default=3,
    )
    to: Output = output_options(
        endings_of("text", "markdown", "json", "html", "csv"),
        "the comparison: text, Markdown, JSON, an HTML page, or CSV with a row per rule",
    )
    witness: str | None = option(
        "--witness",
        type=click.Path(dir_okay=False, allow_dash=True),
        metavar="FILE",
        help="Write the traces that one rulebook forbids and the other allows to FILE, as JSON "
        "Lines.",
    )
    at: str = shared.no_cache_and(shared.at_option)

    def question(self, kind: str, rulebooks: Sequence[str]) -> AnswerQuestion:
        """The question of this kind, whose answer is the same wherever it is written."""
        same = replace(self, to=Output("", self.to.form), witness=None)
        shown = repr((same, width_of(self.to), wants_color(sys.stdout)))
        return AnswerQuestion(("diff", kind, shown, *rulebooks), search_path())


@verb
def command(
    *,
    rulebooks: tuple[str, ...] = shared.rulebooks_argument("RULEBOOK... [RULE]", required=False),
    asked: DiffOptions = gathered(DiffOptions),
) -> int:
    """Compare two RULEBOOKs: which rules of the first are stricter or laxer than the second's.

    Both are names or paths of sources. Every rule that differs has a line; for a RULE, or one of
    --rule or --pair, short traces show it that one rulebook forbids and the other allows. With
    --topic, any number of rulebooks are laid side by side in their own words; with --all, each is
    compared with each in an overview.

    Exit status: 0 no difference, 1 differences found, 2 a question could not be answered; with
    --topic 0.
    """
    to, witness = asked.to, asked.witness
    if len(rulebooks) > 2 and not asked.every and asked.topic is None:
        rulebooks, rule = books_and_rule(rulebooks, "diff")
        asked = asked if rule is None else replace(asked, patterns=(*asked.patterns, rule))
    rulebooks = sources_of_rulebooks(rulebooks, "cannot be compared")
    chosen = bool(asked.patterns or asked.paired)
    if asked.topic is not None:
        if asked.every or chosen or witness is not None or len(rulebooks) < 2:
            raise click.UsageError(
                "--topic lays the words of two or more rulebooks side by side, without --rule, "
                "--pair, --all and --witness"
            )
        on_topic = partial(_on_topic, rulebooks, asked.topic, asked)
        put_answer(asked.question("on", rulebooks).answer(on_topic), to)
        return ExitStatus.OK
    if asked.every:
        if asked.paired:
            raise click.UsageError("--pair is for two rulebooks, not for --all")
        if witness is not None:
            raise click.UsageError("--witness is for two rulebooks, not for --all")
        return _compared(rulebooks, asked)
    if len(rulebooks) != 2:
        books = " ".join(rulebooks)
        raise click.UsageError(
            f"it compares two rulebooks; for {len(rulebooks)}, use `rulec diff --all {books}`, or "
            f"`rulec diff {books} --topic overtaking`"
            if len(rulebooks) > 2
            else f"with which rulebook is it to be compared? As in `rulec diff {books or 'de'} nl`"
        )
    question = asked.question("two", rulebooks)
    known = question.recall() if witness is None else None
    if known is None:
        warned: list[Diagnostic] = []
        difference = _difference(rulebooks, asked, warned)
        if witness is not None:
            _write_witnesses(difference, witness)
        in_full = asked.verbose or chosen
        text = lazy.diff_formats.render(difference, to.form, width_of(to), in_full=in_full)
        known = text, difference.is_complete, difference.is_none
        if difference.is_complete and not warned:
            question.remember(known, difference.files)
    text, is_complete, is_none = known
    put_answer(text, to)
    return ExitStatus.after(answered=is_complete, failed=not is_none)


def _difference(
    rulebooks: Sequence[str], asked: DiffOptions, warned: list[Diagnostic]
) -> lazy.RulebookDiff:
    """The differences of two rulebooks; their warnings are printed, and added to ``warned``."""

    def warn(diagnostics: Sequence[Diagnostic]) -> None:
        print_diagnostics(diagnostics)
        warned.extend(diagnostics)

    named = []
    if asked.paired or asked.patterns:
        named = [lazy.load_rulebook(name, search_path(), asked.at) for name in rulebooks]
        refuse_unmatched(asked.patterns, named)
    with progress("comparing", None) as tell:
        first, second = rulebooks
        return rulec.Session(search_path(), asked.at, warn).diff(
            first,
            second,
            patterns=asked.patterns,
            step_s=asked.step_s,
            witnesses=asked.n_witnesses,
            paired=_pairs(asked.paired, named),
            on_progress=tell,
        )


def _on_topic(
    rulebooks: Sequence[str], topic: str, asked: DiffOptions
) -> tuple[str, Sequence[str]]:
    """What rulebooks say on a topic, and the files that were read."""
    read = [lazy.read_rulebook(name, search_path(), asked.at) for name in rulebooks]
    books = rules_on_topic([loaded.rulebook for loaded in read], topic)
    form, width = asked.to.form, width_of(asked.to)
    text = lazy.topic_report.render(books, topic, form, width, in_full=asked.verbose)
    return text, [path for loaded in read for path in loaded.sources]


def _write_witnesses(difference: lazy.RulebookDiff, path: str) -> None:
    with output_stream(Output(path, "jsonl")) as (stream, name):
        number = lazy.json_lines.write_traces(difference.witnesses, stream)
    print_remark(f"wrote {counted(number, 'trace')} to {name}")


def _compared(rulebooks: Sequence[str], asked: DiffOptions) -> int:
    """Write the overview of these rulebooks, or of all, and return the status."""
    to = asked.to
    names = list(dict.fromkeys(rulebooks or available_rulebooks(search_path())))
    question = asked.question("named" if rulebooks else "all", names)
    known = question.recall()
    if known is None:
        with answer_lines(to) as write:
            text, alone, is_complete, is_uniform, paths = _matrix(
                names, asked, write, is_all=not rulebooks
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
    names: Sequence[str], asked: DiffOptions, write: Callable[[str], object], *, is_all: bool
) -> tuple[str, tuple[str, ...], bool, bool, list[str]]:
    """The overview, the rulebooks left out, whether it is complete and uniform, and the files read.

    It is written as it is made; for fewer than two rulebooks it is empty.
    """
    shown = asked.to.form, width_of(asked.to)
    paths: list[str] = []
    parts: list[str] = []

    def books() -> Iterator[lazy.Rulebook]:
        # Treaties before the rulebooks that extend them, so that the treaty is law A.
        for reference, name in lazy.named_by_heads(names, search_path()).items():
            loaded = None
            with errors_told():
                loaded = lazy.read_rulebook(reference, search_path(), asked.at)
            if loaded is not None:
                paths.extend(loaded.sources)
                yield replace(loaded.rulebook, name=name)

    def put(text: str) -> None:
        if text:
            parts.append(text)
            write(text)

    matrix = lazy.ComparisonMatrix((), ())
    with progress("comparing", len(names)) as tell:
        for matrix in lazy.growing_matrices(books(), asked.patterns, asked.step_s):
            tell(len(matrix.books))
            lines = lazy.matrix_report.last_pairs(matrix, *shown)
            if lines and not parts:
                put(lazy.matrix_report.opening(*shown))
            put("\n".join(lines))
    refuse_unmatched(asked.patterns, matrix.books)
    is_read = len(matrix.books) == len(names)
    uses = Counter(rule.name for book in matrix.books for rule in book.rules)
    alone = tuple(
        book.name
        for book in matrix.books
        if is_all and all(uses[rule.name] == 1 for rule in book.rules)
    )
    matrix = matrix.without(alone)
    if len(matrix.books) > 1:
        put(lazy.matrix_report.render(matrix, *shown))
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
