"""``rulec audit``: what rulebooks rest on."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rulec.analysis.audit.audit_kinds import KINDS
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.scenario_options import recording_options, recording_source
from rulec.cli.options.shell_completion import complete_rulebooks
from rulec.cli.options.verb_class import Verb
from rulec.cli.output import errors_told, open_session, put_answer, sources_of_rulebooks, width_of
from rulec.cli.standard_input import read_as_file

if TYPE_CHECKING:
    from rulec.analysis.audit.rulebook_audit import Audit
    from rulec.analysis.audit.source_audit import SourceAudit


@click.command(cls=Verb)
@shared.rulebooks_argument()
@output_options(endings_of("text", "markdown", "json"), "the audit")
@click.option(
    "--fail-on",
    "fatal",
    type=click.Choice([*KINDS, "any"]),
    multiple=True,
    metavar="KIND",
    help="A kind of finding that makes the exit status 1; may be given several times, `any` is "
    "every kind. With --compare only new findings count.",
)
@click.option("--examples", "run", is_flag=True, help="Run the examples, and name those that fail.")
@click.option(
    "--compare",
    metavar="OLD",
    callback=read_as_file,
    shell_complete=complete_rulebooks,
    help="Say what has changed since an older audit (.json), or against another rulebook.",
)
@click.option(
    "--source",
    metavar="FILE|FORMAT",
    help="Say which rules can be judged on what a recording tells, or files of a format, one of "
    "`rulec formats`, and which words the others lack.",
)
@click.option(
    "--law",
    type=click.Path(dir_okay=False),
    callback=read_as_file,
    help="Look for what the rules of one RULEBOOK cite in the text of its law (Markdown or plain).",
)
@click.option(
    "--law-now",
    type=click.Path(dir_okay=False),
    callback=read_as_file,
    help="With --law: name the rules that rest on what has changed since in this text.",
)
@recording_options
@shared.at_option
def command(
    rulebooks: tuple[str, ...],
    to: Output,
    fatal: tuple[str, ...],
    run: bool,
    compare: str | None,
    source: str | None,
    law: str | None,
    law_now: str | None,
    at: str,
    **options: Any,
) -> int:
    """Say what every RULEBOOK (a name, or the path of a source) rests on.

    That is: rules that cite no provision, that lack examples or were never verified, what is soft,
    dropped, left out or in force for a time only, the provisions covered, and words in no rule.

    Exit status: 0 done, 1 --fail-on says so, 2 a rulebook could not be read.
    """
    # Rulebooks and their automata, 180 ms: not for --help.
    from rulec.analysis.audit.rulebook_audit import compare_audits
    from rulec.analysis.audit.saved_audit import read_audits
    from rulec.report.rulebooks.audit_report import render

    rulebooks = sources_of_rulebooks(rulebooks, "cannot be audited")
    if law_now is not None and law is None:
        raise click.UsageError("--law-now needs --law, the text that it is compared with")
    if law is not None and len(rulebooks) > 1:
        raise click.UsageError("--law is the law of one rulebook; audit the others by themselves")
    where = recording_source(source or "", options)
    older = None
    if compare is not None:
        if Path(compare).suffix == ".json":
            older = read_audits(Path(compare))
        else:
            older = (open_session(at).audit(compare, run_examples=run),)
    audits: list[Audit] = []
    sources: list[SourceAudit] = []
    for rulebook in rulebooks:
        with errors_told():
            done = open_session(at).audit(rulebook, run_examples=run, law=law, law_now=law_now)
            if source is not None:
                sources.append(open_session(at).audit_source(rulebook, source, where))
            audits.append(done)
    against = {} if older is None else compare_audits(audits, older)
    if audits or to.form == "json":
        put_answer(render(audits, against, to.form, width_of(to), sources), to)
    findings = [
        finding
        for done in audits
        for finding in (done.findings if older is None else against[done.rulebook].appeared)
    ]
    return ExitStatus.after(
        answered=len(audits) == len(rulebooks),
        failed=any("any" in fatal or finding.kind in fatal for finding in findings),
    )
