"""From a rulebook's source to automata, to its examples' verdicts, and to what it rests on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from rulec.automata.compiled import CompiledRulebook
from rulec.diagnostics import Diagnostic
from rulec.logic.timing import speaks_of_seconds
from rulec.runtime.numbers import exact
from rulec.runtime.verify import check_step

if TYPE_CHECKING:
    from rulec.analysis.audit import Audit
    from rulec.automata.any_step import AnyStep
    from rulec.rulebook.model import Rulebook
    from rulec.runtime.examples import ExampleRun


def load_rulebook(
    reference: str | Path, search_path: Sequence[str | Path] = (), at: str = ""
) -> Rulebook:
    """A rulebook as meant on the day ``at`` (ISO), from its name or its source's path.

    If ``at`` is empty the day is that of the rulebook's `law` line, else today. Raises RulecError.
    """
    from rulec.rulebook.loader import load_rulebook as load

    return load(reference, [Path(folder) for folder in search_path], at)


def compile_rulebook(
    reference: str | Path | Rulebook | CompiledRulebook,
    search_path: Sequence[str | Path] = (),
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
    step_s: Fraction | float | None = None,
    at: str = "",
) -> CompiledRulebook:
    """Compile a rulebook: given by name, by path (source or compiled), or itself.

    ``warn`` is told what is odd, but not wrong, in a source: an example that comes out otherwise
    than it says, for one. ``step_s`` (above 0, a float meaning the decimal that is written) is the
    step of the traces that rules with bounds in seconds are compiled for; else it is that of their
    own examples. ``at``: as for ``load_rulebook``; what has been compiled has its day.

    Raises:
        RulecError: with every mistake in the source, or why it cannot be compiled or read; R0407
            for a bound that is no multiple of the step, R0507 if it has been compiled for another.
    """
    step = None if step_s is None else exact(step_s)
    found = machines(reference, search_path, warn, at)
    if not isinstance(found, CompiledRulebook):
        return found.at_own_steps() if step is None else found(step)
    for rule in found.rules:
        if step is not None:
            check_step(rule, step)
    return found


def machines(
    reference: str | Path | Rulebook | CompiledRulebook | AnyStep,
    search_path: Sequence[str | Path] = (),
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
    at: str = "",
) -> CompiledRulebook | AnyStep:
    """As ``compile_rulebook``; if the step of traces makes a difference, for those of any step."""
    if isinstance(reference, CompiledRulebook):
        return reference
    if isinstance(reference, str | Path) and Path(reference).suffix == ".json":
        from rulec.automata.compiled_file import read_compiled

        return read_compiled(Path(reference))
    from rulec.automata.any_step import AnyStep

    if isinstance(reference, AnyStep):
        return reference
    if not isinstance(reference, str | Path):
        every = AnyStep(reference)
        return every if every.depends() else every.at_own_steps()
    from rulec.rulebook.loader import read_rulebook
    from rulec.runtime.examples import run_all, surprise

    loaded = read_rulebook(reference, [Path(folder) for folder in search_path], at)
    every = AnyStep(loaded.rulebook)
    # A rule with bounds in seconds but no examples need not fit the step that those would have.
    rules = tuple(
        one for one in loaded.rulebook.rules if one.examples or not speaks_of_seconds(one.formula)
    )
    outcomes = run_all(replace(loaded.rulebook, rules=rules), every.at_own_steps(rules)).outcomes
    warn([*loaded.warnings, *(surprise(one) for one in outcomes if not one.passed)])
    return every if every.depends() else every.at_own_steps()


def run_examples(
    reference: str | Path,
    search_path: Sequence[str | Path] = (),
    pattern: str | None = None,
    at: str = "",
) -> ExampleRun:
    """Compile a rulebook, given by name or by its source's path, and run its examples.

    ``pattern``: run only those whose ``RULE`` or ``RULE/LABEL`` it matches, ``*`` and ``?`` being
    wild. ``at``: as for ``load_rulebook``. Raises RulecError like ``compile_rulebook``.
    """
    from rulec.automata.any_step import AnyStep
    from rulec.rulebook.loader import read_rulebook
    from rulec.runtime.examples import run_all

    loaded = read_rulebook(reference, [Path(folder) for folder in search_path], at)
    compiled = AnyStep(loaded.rulebook).at_own_steps()
    return run_all(loaded.rulebook, compiled, loaded.warnings, pattern)


def audit_rulebook(
    reference: str | Path,
    search_path: Sequence[str | Path] = (),
    at: str = "",
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
    *,
    run: bool = False,
) -> Audit:
    """What a rulebook, given by name or by its source's path, rests on.

    ``warn`` is told what is odd in it. ``run``: compile it, and find out which examples fail.
    ``at``: as for ``load_rulebook``. Raises RulecError.
    """
    from rulec.analysis.audit import audit
    from rulec.analysis.inheritance import read_with_inheritance

    loaded, inherited = read_with_inheritance(reference, search_path, at)
    warn(loaded.warnings)
    outcomes = run_examples(reference, search_path, at=at).outcomes if run else ()
    failing = [(one.rule.name, one.name) for one in outcomes if not one.passed]
    return audit(loaded.rulebook, inherited, failing)
