"""The compiler on one page: source text, trees, rulebook, formulas, automata.

Each call takes the result of the one before it. Errors are raised as RulecError: a missing file by
``find``; all mistakes in the sources by ``resolve``; bounds that do not fit the step, and automata
that are too large, by ``build_automata``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from fractions import Fraction
from pathlib import Path

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.compiled_cache import remembered
from rulec.automata.compiler import lower
from rulec.automata.step_compilation import StepCompiler, build_automata
from rulec.book_tests.example_runs import example_warnings
from rulec.diagnostics import Diagnostic, RulecError
from rulec.rulebook.loader import find, parse_all
from rulec.rulebook.loader import resolve_trees as resolve
from rulec.rulebook.reading.reading_cache import BookQuestion


def compile_source(
    reference: str | Path,
    search_path: Sequence[str | Path] = (),
    at: str = "",
    step_s: Fraction | None = None,
    *,
    on_warning: Callable[[Sequence[Diagnostic]], object],
    question: BookQuestion | None = None,
) -> CompiledRulebook:
    """Compile a rulebook, given by name or by its source's path.

    Args:
        reference: as for ``load_rulebook``.
        search_path: folders of rulebooks and vocabularies.
        at: the day (ISO) whose law applies; if empty, that of its `law` line or else today.
        step_s: the seconds between two states of the traces to be judged; None for the step of each
            rule's own examples, and then for any other step that occurs.
        on_warning: called with warnings, such as an example whose verdict is not the stated one.
        question: the key under which the cache stores the rulebook; None to store nothing.
    """
    file = find(reference, search_path)
    trees = parse_all(file)
    book = resolve(trees, at)
    steps = StepCompiler(book.rulebook)
    warnings = [*book.warnings, *example_warnings(book.rulebook, steps.at_own_steps)]
    on_warning(warnings)
    compiled = build_automata(lower(book.rulebook, step_s), steps)
    if question is None or trees.dependencies is None:
        return compiled
    about = warnings, trees.dependencies
    if step_s is None:
        return remembered(question, compiled, steps, *about)
    with suppress(RulecError):  # for its own steps an automaton may be too large
        remembered(question, build_automata(lower(book.rulebook), steps), steps, *about)
    return compiled
