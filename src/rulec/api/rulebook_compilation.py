"""Compiling rules, given as a name, a path, a rulebook or already compiled."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from rulec.api import lazy_imports as lazy
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.bundle.required_signature import refuse_source
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import Diagnostic
from rulec.diagnostics.argument_kinds import finite
from rulec.rulebook.rulebook_model import Rulebook

if TYPE_CHECKING:
    from rulec.automata.outcome_machine import OutcomeMachine

    Rules: TypeAlias = str | Path | Rulebook | CompiledRulebook
    """A name, the path of a source or compiled file (.json), or a rulebook, compiled or not."""


def machines(
    rules: Rules,
    search_path: Sequence[str | Path] = (),
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
    at: str = "",
) -> CompiledRulebook:
    """Compile rules into automata that adapt to any trace's step.

    ``warn`` is called with warnings about a source, such as an example whose verdict is not the
    stated one. ``at`` is the day (ISO) whose law applies; if empty, that of the rulebook's `law`
    line or else today. A source's automata are taken from the cache if nothing has changed, and are
    stored there.
    """
    # Called for every trace, so the fast case of a compiled rulebook comes first.
    if isinstance(rules, CompiledRulebook):
        return rules
    return compile_rulebook(rules, search_path, warn, at=at)


def _of_source(
    reference: str | Path,
    search_path: Sequence[str | Path],
    warn: Callable[[Sequence[Diagnostic]], object],
    step: Fraction | None,
    *,
    at: str,
) -> CompiledRulebook:
    refuse_source(reference)
    question = lazy.question_of(reference, search_path, at)
    known = lazy.compiled_cache.recalled(question)
    if known is not None:
        warn(known[1])
        return known[0] if step is None else replace(known[0].at_step(step), recompile=None)
    return lazy.compile_source(reference, search_path, at, step, on_warning=warn, question=question)


def _prefixes(rulebook: CompiledRulebook) -> Mapping[str, OutcomeMachine | None]:
    """The machines for incomplete traces, which compiled files of version 3 lack."""
    return lazy.prefix_machines(rulebook)


def compile_rulebook(
    reference: Rules,
    search_path: Sequence[str | Path] = (),
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
    step_s: Fraction | float | None = None,
    at: str = "",
) -> CompiledRulebook:
    """Compile rules for one step, or for any.

    ``step_s`` (above 0, a float meaning its decimal notation) is that step. Without it the rules,
    compiled for the steps of their own examples, adapt to any trace's step. R0507 if the rules have
    been compiled for another step alone.
    """
    finite("step_s", step_s)
    step = None if step_s is None else exact_step(step_s)
    if isinstance(reference, str | Path):
        if Path(reference).suffix != ".json":
            return _of_source(reference, search_path, warn, step, at=at)
        reference = lazy.read_compiled(Path(reference), at)
        if reference.prefixes is None:
            reference = replace(reference, prefixes=_prefixes)
        return reference if step is None else replace(reference.at_step(step), recompile=None)
    if isinstance(reference, CompiledRulebook):
        return reference if step is None else reference.at_step(step)
    if not isinstance(reference, Rulebook):
        raise TypeError(
            f"rules are a rulebook's name, its path, or a Rulebook, not {type(reference).__name__}"
        )

    return lazy.build_automata(lazy.compiler.lower(reference, step), lazy.StepCompiler(reference))
