"""Questions about rulebooks given by name or by path."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from rulec.analysis.audit.rulebook_audit import Audit, audit
from rulec.analysis.diff.rulebook_comparison import RulebookDiff, diff_rulebooks, setting_pairs
from rulec.analysis.lineage.book_lineage import read_with_lineage
from rulec.analysis.lint.rulebook_findings import rulebook_findings
from rulec.automata.step_compilation import StepCompiler
from rulec.book_tests.example_runs import ExampleRun, run_rulebook_examples
from rulec.diagnostics import Diagnostic
from rulec.rulebook.loader import read_rulebook


def run_examples(
    reference: str | Path,
    search_path: Sequence[str | Path] = (),
    pattern: str | None = None,
    at: str = "",
) -> ExampleRun:
    """Compile a rulebook, given by name or path, and run its examples.

    ``pattern``: run only those whose ``RULE`` or ``RULE/LABEL`` it matches, ``*`` and ``?`` being
    wild. ``at``: as for ``load_rulebook``. Raises RulecError.
    """
    loaded = read_rulebook(reference, search_path, at)
    compiled = StepCompiler(loaded.rulebook).at_own_steps()
    return run_rulebook_examples(loaded.rulebook, compiled, loaded.warnings, pattern)


def audit_rulebook(
    reference: str | Path,
    search_path: Sequence[str | Path] = (),
    at: str = "",
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
    *,
    run: bool = False,
) -> Audit:
    """Audit a rulebook, given by name or by its source's path.

    ``warn`` is told what is odd in it. ``run``: compile it, and find out which examples fail.
    ``at``: as for ``load_rulebook``. Raises RulecError.
    """
    loaded, inherited = read_with_lineage(reference, search_path, at)
    warn(loaded.warnings)
    outcomes = run_examples(reference, search_path, at=at).outcomes if run else ()
    failing = [(outcome.rule.name, outcome.name) for outcome in outcomes if not outcome.passed]
    return audit(loaded.rulebook, inherited, failing)


def compare_rulebooks(
    first: str | Path,
    second: str | Path,
    search_path: Sequence[str | Path] = (),
    at: str = "",
    patterns: Sequence[str] = (),
    step_s: Fraction | None = None,
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
    tell: Callable[[float], object] = lambda _: None,
    most: int = 1,
) -> RulebookDiff:
    """Compare the rules of two rulebooks, given by name or path.

    ``warn`` is told what is odd in them, ``tell`` how many rules have been compared; the rest is
    as for ``rulec.analysis.diff.rulebook_comparison.diff_rulebooks``. Raises RulecError.
    """
    one, lineage = read_with_lineage(first, search_path, at)
    two, second_lineage = read_with_lineage(second, search_path, at)
    warn(list(dict.fromkeys((*one.warnings, *two.warnings))))
    diff = diff_rulebooks(
        first=one.rulebook,
        second=two.rulebook,
        patterns=patterns,
        step_s=step_s,
        tell=tell,
        most=most,
    )
    # What rules that were not asked for depend on is not asked for either.
    return diff if patterns else replace(diff, settings=setting_pairs(lineage, second_lineage))


def analyze_rulebook(
    reference: str | Path,
    search_path: Sequence[str | Path] = (),
    at: str = "",
    tell: Callable[[float], object] = lambda _: None,
) -> tuple[Diagnostic, ...]:
    """Analyze a rulebook, given by name or path, by its automata.

    ``tell`` is told how many rules have been looked at. ``at``: as for ``load_rulebook``. Raises
    RulecError.
    """
    loaded = read_rulebook(reference, search_path, at)
    book = loaded.rulebook
    above = [file.span.source.name for file in loaded.books[-2:-1]]
    # On the same side of the road: a treaty's near side is that of the party's traffic.
    bases = [read_rulebook(Path(name), search_path, book.at, book.traffic) for name in above]
    extends = loaded.books[-1].extends
    return rulebook_findings(
        book, [base.rulebook for base in bases], tell, extends.span if extends else None
    )
