"""The examples of several rulebooks, run in one process or in several."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from rulec.automata.step_compilation import StepCompiler
from rulec.batch.batch_messages import process_lost
from rulec.batch.jobs import Jobs, LostTask
from rulec.batch.worker_pool import in_order
from rulec.book_tests.example_coverage import RuleCoverage, coverage
from rulec.book_tests.example_runs import ExampleRun, is_chosen, run_rulebook_examples
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.fault_messages import contained
from rulec.rulebook.reading.rulebook_reader import read_rulebook


@dataclass(frozen=True, slots=True)
class ExampleRequest:
    """Where to look for rulebooks, on which day they apply, and which examples to run.

    ``measured``: also compute the coverage.
    """

    folders: Sequence[str | Path] = ()
    at: str = ""
    patterns: Sequence[str] = ()
    measured: bool = False


def run_examples(request: ExampleRequest, rulebook: str | Path) -> ExampleRun:
    """Run a rulebook's examples. Raises RulecError.

    With patterns only the rules that one of them matches are compiled, if there are any.
    """
    loaded = read_rulebook(rulebook, request.folders, request.at)
    book = loaded.rulebook
    rules = tuple(rule for rule in book.rules if is_chosen(rule, request.patterns))
    chosen = replace(book, rules=rules) if rules else book
    compiled = StepCompiler(book).at_own_steps(chosen.rules)
    run = run_rulebook_examples(chosen, compiled, loaded.warnings, request.patterns)
    return replace(run, rule_names=tuple(rule.name for rule in book.rules))


MeasuredRun = tuple[ExampleRun, tuple[RuleCoverage, ...]]


def measured_runs(
    request: ExampleRequest,
    rulebooks: Sequence[str],
    jobs: Jobs,
    lost: Callable[[str, int | None], object],
) -> Iterator[MeasuredRun | RulecError]:
    """The run of each rulebook with its coverage, or why there is none, in the rulebooks' order.

    ``lost`` is called with a rulebook whose process was killed (and is started again), and the
    signal.
    """
    for rulebook, answer in in_order(partial(_measured, request), rulebooks, jobs, lost=lost):
        if isinstance(answer, LostTask):
            yield process_lost(rulebook, answer.signal_number, "tested")
        else:
            yield answer


def _measured(request: ExampleRequest, rulebook: str) -> Iterator[MeasuredRun | RulecError]:
    try:
        with contained("not tested", SourceLocation(rulebook)):
            run = run_examples(request, rulebook)
            yield run, coverage(run) if request.measured else ()
    except RulecError as error:
        yield error
