"""``rulec show --audit``: the basis of rulebooks."""

from __future__ import annotations

from pathlib import Path

import click

from rulec.analysis.audit.audit_kinds import KINDS
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.recording_options import RecordingOptions, as_typed, recording_options
from rulec.cli.options.shell_completion import complete_rulebooks
from rulec.cli.options.standard_input import read_as_file
from rulec.cli.options.verb_class import option, verb
from rulec.cli.output import errors_told, open_session, put_answer, sources_of_rulebooks, width_of

_FOUND_WITH = {
    "failing": "--examples",
    "not-found": "--law",
    "unread": "--law",
    "law-changed": "--law-now",
}
"""The kinds of findings that are found only with an option."""


@verb
def command(
    *,
    rulebooks: tuple[str, ...] = shared.rulebooks_argument(),
    to: Output = output_options(endings_of("text", "markdown", "json"), "the audit"),
    fatal: tuple[str, ...] = option(
        "--fail-on",
        type=click.Choice([*KINDS, "any"]),
        multiple=True,
        metavar="KIND",
        help="A kind of finding that makes the exit status 1; may be given several times; `any` "
        "means every kind. With --compare only new findings count.",
    ),
    run: bool = option(
        "--examples", is_flag=True, help="Also run the examples and name those that fail."
    ),
    every: bool = option(
        "--all", is_flag=True, help="Show every finding's note, and all articles."
    ),
    compare: str | None = option(
        "--compare",
        metavar="OLD",
        callback=read_as_file,
        shell_complete=complete_rulebooks,
        help="List what has changed since an older audit (.json), or compared to another rulebook.",
    ),
    source: str | None = option(
        "--source",
        metavar="FILE|FORMAT",
        help="List which rules can be judged from a recording, or from files of a format (one of "
        "`rulec list formats`), and which words the other rules lack.",
    ),
    law: str | None = option(
        "--law",
        type=click.Path(dir_okay=False),
        callback=read_as_file,
        help="Look up what the rules of one RULEBOOK cite in this text of the law (Markdown or "
        "plain).",
    ),
    law_now: str | None = option(
        "--law-now",
        type=click.Path(dir_okay=False),
        callback=read_as_file,
        help="With --law: the newer text; name the rules that rest on provisions changed in it.",
    ),
    recorded: RecordingOptions = recording_options,
    at: str = shared.at_option,
) -> int:
    """Report what each RULEBOOK (a name, or the path of a source) is based on.

    Lists rules that cite no provision, lack examples or were never verified; rules that are soft,
    dropped, left out or in force only for a time; the provisions covered; and unused words.

    Exit status: 0 done, 1 a finding named by --fail-on, 2 a rulebook could not be read.
    """
    rulebooks = sources_of_rulebooks(rulebooks, "cannot be audited")
    if law_now is not None and law is None:
        raise click.UsageError("--law-now needs --law, the text that it is compared with")
    if law is not None and len(rulebooks) > 1:
        raise click.UsageError("--law is the law of one rulebook; audit the others by themselves")
    # Nothing would ever be found, and the audit always succeed.
    given = {"--examples": run, "--law": law is not None, "--law-now": law_now is not None}
    for kind, named in _FOUND_WITH.items():
        if kind in fatal and not given[named]:
            raise click.UsageError(f"--fail-on {kind} needs {named}: without, none is found")
    if source is None and any(as_typed(recorded)):
        raise click.UsageError(
            "--map, --scenario and --input-format are about a recording: name it by --source"
        )
    where = recorded.source(source or "")
    older = None
    if compare is not None:
        if Path(compare).suffix == ".json":
            older = lazy.read_audits(Path(compare))
        else:
            older = (open_session(at).audit(compare, run_examples=run),)
    audits: list[lazy.Audit] = []
    sources: list[lazy.SourceAudit] = []
    for rulebook in rulebooks:
        with errors_told():
            done = open_session(at).audit(rulebook, run_examples=run, law=law, law_now=law_now)
            if source is not None:
                sources.append(open_session(at).audit_source(rulebook, source, where))
            audits.append(done)
    against = {} if older is None else lazy.compare_audits(audits, older)
    if audits or to.form == "json":
        text = lazy.audit_report.render(
            audits, against, to.form, width_of(to), sources, in_full=every
        )
        put_answer(text, to)
    findings = [
        finding
        for done in audits
        for finding in (done.findings if older is None else against[done.rulebook].appeared)
    ]
    return ExitStatus.after(
        answered=len(audits) == len(rulebooks),
        failed=any("any" in fatal or finding.kind in fatal for finding in findings),
    )
