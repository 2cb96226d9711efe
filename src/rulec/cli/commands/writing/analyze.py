"""``rulec analyze``: defects of rulebooks, found by their rules' automata."""

from __future__ import annotations

from functools import partial

from rulec.analysis.lint.finding_messages import NOT_DECIDED
from rulec.batch.jobs import Jobs
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output
from rulec.cli.options.verb_class import verb
from rulec.cli.output import (
    errors_told,
    open_session,
    print_findings,
    print_lost,
    sources_of_rulebooks,
)
from rulec.diagnostics import Diagnostic
from rulec.report.text.console import progress
from rulec.report.text.terminal_text import counted
from rulec.rulebook.batch.answer_cache import AnswerQuestion
from rulec.settings import search_path


@verb
def command(
    *,
    rulebooks: tuple[str, ...] = shared.rulebooks_argument(),
    to: Output = shared.findings_option,
    fail_on: str = shared.fail_on_option,
    jobs: Jobs = shared.jobs_option("Analyze N rules in parallel"),
    at: str = shared.no_cache_and(shared.at_option),
) -> int:
    """Analyze the automata of RULEBOOKs (names, or paths of sources) for mistakes.

    Finds rules that nothing can violate or satisfy, rules implied by others, triggers that never
    occur, hard rules that contradict each other, and rules weaker than those of the rulebook being
    extended. Contradictions and weaker rules come with a trace that shows them.

    Exit status: 0 no mistakes found, 1 mistakes found, 2 a question could not be answered.
    """
    rulebooks = sources_of_rulebooks(rulebooks, "cannot be analyzed")
    findings: list[Diagnostic] = []
    unread: list[Diagnostic] = []
    for rulebook in dict.fromkeys(rulebooks):
        with errors_told(unread.extend):
            question = AnswerQuestion(("analyze", rulebook, at), search_path())
            known = question.recall()
            if known is not None:
                findings += known
                continue
            with progress(f"analyzing {rulebook}", None) as tell:
                spread = lazy.spreading.spreading(
                    jobs, rulebook, partial(print_lost, "analyzed", rulebook)
                )
                diagnostics = open_session(at).analyze(rulebook, on_progress=tell, spread=spread)
            findings += diagnostics
            read = lazy.read_rulebook(rulebook, search_path(), at)
            question.remember(diagnostics, read.sources)
    status = print_findings(
        list(dict.fromkeys(findings)),
        unread,
        nothing=f"{counted(len(rulebooks), 'rulebook')}, nothing found",
        to=to,
        fail_on=fail_on,
    )
    undecided = any(finding.code == NOT_DECIDED.code for finding in findings)
    return ExitStatus.NOT_ANSWERED if undecided else status
