"""Verbs of a session about rulebooks: explain, diff, analyze, audit, show."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args, overload

from rulec.api import lazy_imports as lazy
from rulec.api.rulebook_verbs import RulebookVerbs
from rulec.api.session_settings import ignore
from rulec.diagnostics import Diagnostic
from rulec.diagnostics.argument_kinds import finite
from rulec.resources import scenarios_folder
from rulec.trace import Trace
from rulec.trace.trace_model import check_trace
from rulec.trace.vocabulary_projection import values_lacking, with_told_values

if TYPE_CHECKING:
    from rulec.analysis.audit.rulebook_audit import Audit
    from rulec.analysis.audit.source_audit import SourceAudit
    from rulec.analysis.diff.rulebook_comparison import RulebookDiff
    from rulec.analysis.lineage.rule_lineage import BookLineage
    from rulec.analysis.lint.questions import Spread
    from rulec.api.rulebook_compilation import Rules
    from rulec.extraction.traces.recorded_drive import Drive
    from rulec.logic.sentences.language import LanguageCode
    from rulec.monitoring.explain.explanation import Explanation
    from rulec.monitoring.verdict import Violation
    from rulec.recordings.recording_format import RecordingSource
    from rulec.report.findings.code_registry import CodeExplanation
    from rulec.report.text.listing import Listed

_NARROWEST = 10
"""The least number of columns for the text of a rule."""

Kind = Literal["rulebooks", "vocabularies", "scenarios", "codes"]


class RulebookQuestions(RulebookVerbs):
    """The verbs of a session that answer questions about rulebooks."""

    @overload
    def explain(self, subject: str) -> CodeExplanation: ...

    @overload
    def explain(self, subject: Violation, trace: Trace | Drive, rules: Rules) -> Explanation: ...

    def explain(
        self,
        subject: str | Violation,
        trace: Trace | Drive | None = None,
        rules: Rules | None = None,
    ) -> CodeExplanation | Explanation:
        """Explain a code such as R0104, or a trace's violations by state.

        For a recorded ``Drive`` the margins include the numbers from which its signals were
        derived.

        Raises KeyError for an unknown code.
        """
        if isinstance(subject, str):
            code = lazy.all_codes().get(subject.upper())
            if code is None:
                raise KeyError(f"there is no code {subject}")
            return code
        if trace is None or rules is None:
            raise TypeError("explaining a violation needs the trace and the rules")
        if isinstance(trace, Trace):
            check_trace(trace)
            return lazy.explain(subject, trace, self._compiled(rules).fitted_to(trace.step_s))
        return lazy.explain_drive(subject, trace, self._compiled(rules))

    def diff(
        self,
        first: str | Path,
        second: str | Path,
        *,
        patterns: str | Sequence[str] = (),
        step_s: Fraction | float | None = None,
        witnesses: int = 1,
        paired: Mapping[str, str] | None = None,
        on_progress: Callable[[float], object] = ignore,
    ) -> RulebookDiff:
        """Compare the rules of two rulebooks, with witnesses for each difference.

        Both are names or paths of sources. With ``patterns`` only rules whose name matches one of
        them are compared; ``*`` and ``?`` are wildcards. ``step_s`` is the step of the traces on
        which rules with bounds in seconds are compared, ``witnesses`` the number of traces to find
        for each difference; ``paired`` maps rules of the first rulebook to rules of the second with
        another name; ``on_progress`` is called with the number of rules compared. Raises
        RulecError.
        """
        finite("step_s", step_s)
        book, lineage, _ = lazy.read_with_lineage(first, self.search_path, self.at)
        second_book, second_lineage, _ = lazy.read_with_lineage(second, self.search_path, self.at)
        self._warn(list(dict.fromkeys((*book.warnings, *second_book.warnings))))
        diff = lazy.diff_rulebooks(
            first=book.rulebook,
            second=second_book.rulebook,
            patterns=(patterns,) if isinstance(patterns, str) else patterns,
            step_s=None if step_s is None else lazy.exact_step(step_s),
            tell=on_progress,
            most=witnesses,
            paired=paired or {},
        )
        # With patterns no settings are compared, since other rules may depend on them.
        settings = () if patterns else lazy.setting_pairs(lineage, second_lineage)
        return replace(diff, settings=settings, files=(*book.sources, *second_book.sources))

    def analyze(
        self,
        reference: str | Path,
        *,
        on_progress: Callable[[float], object] = ignore,
        spread: Spread | None = None,
    ) -> tuple[Diagnostic, ...]:
        """Find defects of a rulebook by its rules' automata. Raises RulecError.

        ``on_progress`` is called with the number of questions answered so far. ``spread`` answers
        them in advance, as the command does in several processes.
        """
        trees = lazy.read_trees(reference, self.search_path)
        book, extends = lazy.resolve_trees(trees, self.at).rulebook, trees.books[-1].extends
        above = [Path(file.span.source.name) for file in trees.books[-2:-1]]
        # Compared for the same side of traffic: a treaty's near side is that of the party.
        bases = [
            lazy.read_rulebook(name, self.search_path, book.at, book.traffic) for name in above
        ]
        findings = lazy.rulebook_findings(
            book,
            [base.rulebook for base in bases],
            on_progress,
            extends=extends.span if extends else None,
            spread=spread,
            changes=lazy.changing_lines(trees.books),
        )
        return lazy.without_allowed(findings)

    def audit(
        self,
        reference: str | Path,
        *,
        run_examples: bool = False,
        law: str | Path | None = None,
        law_now: str | Path | None = None,
    ) -> Audit:
        """Report the basis of a rulebook: citations, examples, certainty. Raises RulecError.

        ``run_examples``: also compile it and report its failing examples. ``law`` is a file with
        the text of its law, in which the cited provisions are looked up; ``law_now`` is the present
        version of that law, to find changes in what rules rest on.
        """
        loaded, inherited, _ = lazy.read_with_lineage(reference, self.search_path, self.at)
        self._warn(loaded.warnings)
        outcomes = self.test(reference).outcomes if run_examples else ()
        failing = [(outcome.rule.name, outcome.name) for outcome in outcomes if not outcome.passed]
        texts = (
            None if path is None else lazy.read_law_text(Path(path)) for path in (law, law_now)
        )
        return lazy.rulebook_audit.audit(loaded.rulebook, inherited, failing, *texts)

    def audit_source(
        self, reference: str | Path, source: str | Path, where: RecordingSource | None = None
    ) -> SourceAudit:
        """Report which rules can be judged on the data of a source.

        ``source`` is a format, such as ``commonroad``, of which some files may provide less, or a
        file of recorded traffic; ``where`` says how to read that. Raises RulecError.
        """
        rulebook = self.compile(reference)
        told, lacking = lazy.TELLABLE_WORDS.get(str(source)), frozenset[str]()
        form = str(source)
        if told is None:
            recording = lazy.read_recording(where or lazy.RecordingSource(Path(source)))
            drives = lazy.selected_drives(
                recording, lazy.RequestedDrives(), str(source), rulebook.traffic
            )
            told, form = drives.told_words(), recording.form
            types = (lanelet.types for lanelet in recording.lanelets.values())
            lacking = values_lacking(frozenset().union(*types))
        words = with_told_values(told, rulebook.vocabulary, lacking)
        words |= lazy.told_types(form, rulebook.vocabulary)
        return lazy.audit_source(rulebook, str(source), words)

    def tree(self, reference: str | Path) -> BookLineage:
        """Trace everything in a rulebook to its origin, with its changes."""
        return lazy.read_with_lineage(reference, self.search_path, self.at)[1]

    lineage = tree

    def show(self, reference: str | Path, rule: str, *, width: int = 80) -> str:
        """Describe a rule in English, by formula, automaton and examples, as text.

        Raises KeyError for an unknown rule, RulecError.
        """
        if width < _NARROWEST:
            raise ValueError(f"`width` is {_NARROWEST} columns or more, not {width}")
        book = self.load_rulebook(reference)
        chosen = next((known for known in book.rules if known.name == rule), None)
        if chosen is None:
            raise KeyError(f"{book.name} has no rule {rule}")
        compiled = self.compile_rulebook(replace(book, rules=(chosen,)))
        page = lazy.rule_page.page_of(chosen, compiled)
        return lazy.rule_page.as_text(page, book, width)

    def doc(
        self,
        reference: str | Path,
        form: Literal["html", "markdown"] = "html",
        language: LanguageCode = "en",
    ) -> str:
        """A rulebook as a document for lawyers, HTML or Markdown. Raises RulecError.

        The HTML page shows its examples as pictures. Texts by the authors stay in their language.
        """
        if language not in lazy.LANGUAGES:
            raise ValueError(
                f"the language is one of {', '.join(lazy.LANGUAGES)}, not {language!r}"
            )
        loaded, lineage, trees = lazy.read_with_lineage(reference, self.search_path, self.at)
        self._warn(loaded.warnings)
        words = lazy.document_language(loaded.rulebook, language)
        if form == "markdown":
            return lazy.book_document.as_markdown(loaded.rulebook, lineage, trees, words)
        figures = lazy.ExampleFigures(loaded.rulebook.vocabulary)
        text = lazy.book_document.as_markdown(loaded.rulebook, lineage, trees, words, figures.add)
        page = lazy.PageTexts(
            lazy.title_of(loaded.rulebook), lazy.contents_heading(words), language, is_closed=True
        )
        return lazy.html_page.as_html(text, page, figures.by_address)

    def new_rulebook(self, name: str, extends: str | None = None) -> str:
        """The text of a new rulebook, optionally extending another. Raises RulecError."""
        today = datetime.now().astimezone().date()
        if extends is None:
            return lazy.template.new_rulebook(name, today)
        return lazy.template.new_rulebook_upon(name, extends, today, self._folders())

    def list(self, kind: Kind = "rulebooks") -> tuple[Listed, ...]:
        """The available rulebooks, vocabularies, scenarios or codes, with their titles."""
        if kind not in (kinds := get_args(Kind)):
            raise ValueError(f"`kind` is one of {', '.join(kinds)}, not {kind!r}")
        if kind == "codes":
            return tuple(lazy.Listed(text, code.title) for text, code in lazy.all_codes().items())
        if kind == "scenarios":
            abouts = {name: lazy.load_scenario(name).about for name in lazy.available_scenarios()}
            return tuple(
                lazy.Listed(name, " ".join(about.split()), str(scenarios_folder() / f"{name}.toml"))
                for name, about in abouts.items()
            )
        entries = lazy.list_rulebooks if kind == "rulebooks" else lazy.list_vocabularies
        return tuple(
            lazy.Listed(entry.name, entry.title, str(entry.path))
            for entry in entries(self._folders())
        )
