"""Verbs about rulebooks: read, compile, check, test, compare, show."""

# Imports within functions: what all verbs of this file need takes 340 ms, a session alone 25 ms.

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Literal, overload

from rulec.api.session_settings import SessionSettings

if TYPE_CHECKING:
    from rulec.analysis.audit.rulebook_audit import Audit
    from rulec.analysis.diff.rulebook_comparison import RulebookDiff
    from rulec.analysis.lineage.rule_lineage import BookLineage
    from rulec.api.session_settings import Rules
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.book_tests.edge_coverage import RuleCoverage
    from rulec.book_tests.example_runs import ExampleRun
    from rulec.diagnostics import Diagnostic
    from rulec.diagnostics.code import Code
    from rulec.monitoring.explain.explanation import Explanation
    from rulec.monitoring.verdict import Violation
    from rulec.report.text.listing import Listed
    from rulec.rulebook.batch.batch_check import Checked
    from rulec.rulebook.rulebook_model import Rulebook
    from rulec.trace import Trace
    from rulec.vocabulary import Vocabulary

Kind = Literal["rulebooks", "vocabularies", "scenarios", "codes"]


class RulebookVerbs(SessionSettings):
    """The verbs of a session that are about rulebooks."""

    def load_rulebook(self, reference: str | Path) -> Rulebook:
        """Read a rulebook: names resolved, types checked, not compiled.

        Args:
            reference: a name, looked for in the search path and among the rulebooks that ship with
                rulec; or a path, which contains a ``/`` or ends in ``.rules``.

        Raises:
            RulecError: with every mistake in it, in those that it extends, in their vocabularies.
        """
        from rulec.rulebook.loader import read_rulebook

        loaded = read_rulebook(reference, self.search_path, self.at)
        self._warn(loaded.warnings)
        return loaded.rulebook

    def parse_rulebook(self, text: str, name: str = "<text>") -> Rulebook:
        """Parse a rulebook's text, called ``name`` in messages. Raises RulecError."""
        from rulec.rulebook.loader import parse_rulebook

        return parse_rulebook(text, name, self._folders(), self.at)

    def load_vocabulary(self, name: str) -> Vocabulary:
        """Read a vocabulary by its name. Raises RulecError."""
        from rulec.rulebook.loader import load_vocabulary

        return load_vocabulary(name, self._folders())

    def compile_rulebook(
        self, reference: Rules, *, step_s: Fraction | float | None = None
    ) -> CompiledRulebook:
        """Compile a rulebook: name, path of source or compiled file, or Rulebook.

        Without ``step_s`` it fits itself to the step of the traces that it meets; with it, it is
        for this step (s) alone, a float meaning the decimal that is written.

        Raises:
            RulecError: mistakes in the source; R0401 to R0403 if there is no automaton, R0407 for a
                bound that is no multiple of the step, R0507 if it was compiled for another one.
        """
        from rulec.api.workflow import compile_rulebook

        return compile_rulebook(reference, self.search_path, self._warn, step_s, self.at)

    compile = compile_rulebook

    def write_compiled(self, rulebook: CompiledRulebook, folder: str | Path) -> tuple[Path, ...]:
        """Write RULE.hoa for every rule and RULEBOOK.json; the paths. Raises RulecError."""
        from rulec.automata.bundle.bundle_file import write_compiled

        return tuple(write_compiled(rulebook, Path(folder)))

    def check(self, *references: str | Path) -> Checked:
        """List all diagnostics of rulebooks and vocabularies, and raise nothing.

        Each is a name, a file, or a folder (all .rules files in it).
        """
        from rulec.rulebook.batch.batch_check import check

        names = [str(reference) for reference in references]
        return check(names, bytes, self._folders(), self.at)

    def format(self, text: str, name: str = "<text>") -> str:
        """A rulebook's or vocabulary's text in the one canonical form. Raises RulecError."""
        from rulec.rulebook.batch.batch_format import formatted

        return formatted(name, None, text.encode("utf-8", "surrogatepass")).after.decode()

    def test(self, reference: str | Path, pattern: str | None = None) -> ExampleRun:
        """Run a rulebook's examples whose RULE or RULE/LABEL matches the pattern."""
        from rulec.api.rulebook_questions import run_examples

        return run_examples(reference, self.search_path, pattern, self.at)

    def coverage(self, run: ExampleRun) -> tuple[RuleCoverage, ...]:
        """Measure what the examples of a run cover, rule by rule."""
        from rulec.book_tests.edge_coverage import coverage

        return coverage(run)

    @overload
    def explain(self, subject: str) -> Code: ...

    @overload
    def explain(self, subject: Violation, trace: Trace, rules: Rules) -> Explanation: ...

    def explain(
        self, subject: str | Violation, trace: Trace | None = None, rules: Rules | None = None
    ) -> Code | Explanation:
        """Explain a code such as R0104, or a trace's violations by state.

        Raises KeyError for a code that there is not.
        """
        if isinstance(subject, str):
            from rulec.report.findings.code_registry import code_named

            code = code_named(subject.upper())
            if code is None:
                raise KeyError(f"there is no code {subject}")
            return code
        from rulec.monitoring.explain.explanation import explain

        if trace is None or rules is None:
            raise TypeError("explaining a violation takes the trace and the rules")
        return explain(subject, trace, self._compiled(rules).fitted_to(trace.step_s))

    def diff(
        self,
        first: str | Path,
        second: str | Path,
        *,
        patterns: Sequence[str] = (),
        step_s: Fraction | float | None = None,
        witnesses: int = 1,
    ) -> RulebookDiff:
        """Compare the rules of two rulebooks, with witnesses for each difference.

        Args:
            first: a name, or the path of a source.
            second: likewise.
            patterns: compare only rules whose name one of these matches; ``*`` and ``?`` are wild.
            step_s: the step of the traces that rules with bounds in seconds are compared on.
            witnesses: traces to find for each difference.

        Raises:
            RulecError: for what is wrong in one of them.
        """
        from rulec.api.rulebook_questions import compare_rulebooks
        from rulec.automata.thresholds import exact

        return compare_rulebooks(
            first=first,
            second=second,
            search_path=self.search_path,
            at=self.at,
            patterns=patterns,
            step_s=None if step_s is None else exact(step_s),
            warn=self._warn,
            most=witnesses,
        )

    def analyze(self, reference: str | Path) -> tuple[Diagnostic, ...]:
        """Find defects of a rulebook by its rules' automata. Raises RulecError."""
        from rulec.api.rulebook_questions import analyze_rulebook

        return analyze_rulebook(reference, self.search_path, self.at)

    def audit(self, reference: str | Path, *, run_examples: bool = False) -> Audit:
        """Say what a rulebook rests on: citations, examples, certainty. Raises RulecError."""
        from rulec.api.rulebook_questions import audit_rulebook

        return audit_rulebook(reference, self.search_path, self.at, self._warn, run=run_examples)

    def tree(self, reference: str | Path) -> BookLineage:
        """Trace everything in a rulebook to its origin and through its changes."""
        from rulec.analysis.lineage.book_lineage import read_with_lineage

        return read_with_lineage(reference, self.search_path, self.at)[1]

    lineage = tree

    def show(self, reference: str | Path, rule: str, *, width: int = 80) -> str:
        """Describe a rule in English, by formula, automaton and examples, as text.

        Raises KeyError for a rule that there is not, RulecError.
        """
        from dataclasses import replace

        from rulec.report.rulebooks import rule_page

        book = self.load_rulebook(reference)
        chosen = next((known for known in book.rules if known.name == rule), None)
        if chosen is None:
            raise KeyError(f"{book.name} has no rule {rule}")
        compiled = self.compile_rulebook(replace(book, rules=(chosen,)))
        page = rule_page.page_of(chosen, compiled.rules[0], compiled.vocabulary)
        return rule_page.as_text(page, book.name, book.vocabulary, width)

    def doc(self, reference: str | Path, form: Literal["html", "markdown"] = "html") -> str:
        """A rulebook as a lawyers' document, HTML or Markdown. Raises RulecError."""
        from rulec.analysis.lineage.book_lineage import read_with_lineage
        from rulec.report.rulebooks.book_document import CONTENTS, as_markdown, title_of
        from rulec.report.text.html_page import as_html

        loaded, lineage = read_with_lineage(reference, self.search_path, self.at)
        self._warn(loaded.warnings)
        text = as_markdown(loaded, lineage)
        return as_html(text, title_of(loaded.rulebook), CONTENTS) if form == "html" else text

    def new_rulebook(self, name: str, extends: str | None = None) -> str:
        """The text of a new rulebook, perhaps extending another. Raises RulecError."""
        from rulec.rulebook import template

        today = datetime.now().astimezone().date()
        if extends is None:
            return template.new_rulebook(name, today)
        return template.new_rulebook_upon(name, extends, today, self._folders())

    def list(self, kind: Kind = "rulebooks") -> tuple[Listed, ...]:
        """The rulebooks, vocabularies, scenarios or codes that there are, with a title."""
        from rulec.api.name_listing import listed

        return listed(kind, self._folders())
