"""``rulec test``: run the examples of rulebooks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from time import monotonic

import click

from rulec.batch.jobs import Jobs
from rulec.book_tests.book_test_messages import nothing_to_run, untested
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, RenamedOption, endings_of, output_options
from rulec.cli.options.verb_class import gathered, option, verb
from rulec.cli.output import print_lost, put_answer, sources_of_rulebooks, width_of
from rulec.cli.watching import watch as watch_sources
from rulec.cli.watching import watch_option
from rulec.diagnostics import Diagnostic, RulecError
from rulec.report.findings.diagnostics_text import print_diagnostics
from rulec.report.text.console import print_remark
from rulec.rulebook.allowances import without_allowed
from rulec.settings import search_path


@dataclass(frozen=True, kw_only=True)
class TestOptions:
    """The examples to run, the day of law, and the reports wanted."""

    rulebooks: tuple[str, ...] = shared.rulebooks_argument("[RULEBOOK]...", required=False)
    patterns: tuple[str, ...] = shared.rules_option(
        "Run only examples whose RULE or RULE/LABEL matches PATTERN (RULE/NUMBER if it has no "
        "label)",
        former=["--run"],
    )
    to: Output = output_options(
        endings_of("full", "json", "junit"), "the outcomes: text, JSON, or JUnit XML"
    )
    fail_on_empty: bool = option(
        "--fail-on-empty", is_flag=True, help="Fail if there are no examples to run."
    )
    with_coverage: bool = option(
        "--coverage",
        is_flag=True,
        help="List the edges of each rule's automaton that no example takes, and the atoms that "
        "are never both true and false in examples.",
    )
    percent: float | None = option(
        "--fail-under",
        cls=RenamedOption,
        former=["--threshold"],
        type=click.FloatRange(0, 100),
        callback=shared.finite,
        metavar="PERCENT",
        help="Fail if the examples cover less than this of a rulebook's own rules; implies "
        "--coverage.",
    )
    verbose: bool = option(
        "-v", "--verbose", is_flag=True, help="List every example, and all that coverage misses."
    )
    jobs: Jobs = shared.jobs_option("Test N rulebooks in parallel")
    watch: bool = watch_option
    at: str = shared.at_option

    @property
    def measured(self) -> bool:
        """Whether coverage is asked for."""
        return self.with_coverage or self.percent is not None


@verb
def command(*, asked: TestOptions = gathered(TestOptions)) -> int:
    """Run the accept and reject examples of every RULEBOOK.

    RULEBOOK is a name, the path of a source, a pattern, or a folder with rulebooks at any depth;
    the default is the working folder.

    Exit status: 0 all examples pass, 1 some fail, or --fail-on-empty or --fail-under applies, 2 a
    rulebook could not be read or compiled, or --rule matches nothing.
    """
    references = asked.rulebooks or (".",)
    run = partial(_tested, references, asked)
    if asked.watch:
        watch_sources(run, references)
    return run()


def _tested(references: Sequence[str], asked: TestOptions) -> int:
    begun, to, patterns = monotonic(), asked.to, asked.patterns
    rulebooks = sources_of_rulebooks(references, "has no examples")
    runs: list[lazy.ExampleRun] = []
    coverages: list[tuple[lazy.RuleCoverage, ...]] = []
    tested: list[str] = []
    unread: dict[str, Sequence[Diagnostic]] = {}
    request = lazy.ExampleRequest(search_path(), asked.at, patterns, asked.measured)
    answers = lazy.measured_runs(request, rulebooks, asked.jobs, partial(print_lost, "tested"))
    for name, answer in zip(rulebooks, answers, strict=True):
        if isinstance(answer, RulecError):
            print_diagnostics(answer.diagnostics)
            unread[name] = answer.diagnostics
            continue
        run, covers = answer
        print_diagnostics(without_allowed([*run.warnings, *lazy.uncovered_verdicts(run)]))
        runs.append(run)
        tested.append(name)
        coverages.append(covers)
    runs = lazy.example_runs.with_distinct_names(runs, tested)
    answered = not unread
    left_out = [*filter(None, (untested(run.rulebook, run.name, patterns) for run in runs))]
    if answered:
        _refuse_unmatched(runs, patterns, left_out)
    for sentence in left_out:
        print_remark(f"rulec: {sentence}")
    covered = coverages if asked.measured else None
    short = lazy.example_text.shortcomings(
        runs, covered, asked.percent, fail_on_empty=asked.fail_on_empty
    )
    if runs or to.form != "full":
        besides = lazy.Besides(unread, short, monotonic() - begun)
        width, in_full = width_of(to), asked.verbose
        match to.form:
            case "json":
                text = lazy.example_formats.as_json(runs, covered)
            case "junit":
                text = lazy.example_formats.as_junit(runs, covered, besides)
            case _:
                text = lazy.example_text.as_text(runs, covered, besides, width, in_full=in_full)
        put_answer(text, to)
    for sentence in short.values():
        print_remark(f"rulec: {sentence}")
    failed = any(not outcome.passed for run in runs for outcome in run.outcomes)
    return ExitStatus.after(answered=answered, failed=failed or bool(short))


def _refuse_unmatched(
    runs: Sequence[lazy.ExampleRun], patterns: Sequence[str], left_out: Sequence[str]
) -> None:
    """Refuse a pattern that matches no rule and no example: it may be misspelt.

    Rules that are not in force count as matched if anything else is; ``left_out`` tells of them.
    """
    missing = [
        pattern
        for pattern in patterns
        if not any(lazy.is_chosen(rule, [pattern]) for run in runs for rule in run.rulebook.rules)
    ]
    unknown = [
        pattern
        for pattern in missing
        if not any(untested(run.rulebook, run.name, [pattern]) for run in runs)
    ]
    if unknown or (missing and len(missing) == len(patterns)):
        names = dict.fromkeys(name for run in runs for name in run.rule_names)
        not_in_force = () if unknown else left_out
        raise RulecError([nothing_to_run(unknown or missing, list(names), not_in_force)])
