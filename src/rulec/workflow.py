"""The whole of rulec on one page.

    source text -> syntax -> rulebook -> logic -> automata -> runtime -> verdicts
    scenario -> partition -> graph of traces ----------------^

The command line and ``import rulec`` are thin layers over these functions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rulec.automata.compiled import CompiledRulebook
from rulec.diagnostics import Diagnostic, Place, RulecError
from rulec.files import opened
from rulec.logic.timing import speaks_of_seconds
from rulec.maneuvers import Maneuvers, judged, partition_for
from rulec.runtime.numbers import exact
from rulec.runtime.verify import check_step
from rulec.trace import Trace

if TYPE_CHECKING:
    from rulec.analysis.audit import Audit
    from rulec.automata.any_step import AnyStep
    from rulec.drives.judging import JudgedRecording
    from rulec.drives.wanted import Wanted
    from rulec.partition import AdjacencyName, ExtentName, NavigationGraph, PartitionName
    from rulec.rulebook.model import Rulebook
    from rulec.runtime.before import Before
    from rulec.runtime.examples import ExampleRun
    from rulec.scenario import Scenario
    from rulec.scenario.recorded.recording import Recording


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


def read_traces(path: str | Path) -> Iterator[Trace | RulecError]:
    """The traces of a file one by one; in place of a bad one, what is wrong with it.

    The end of its name says its format: `.csv`, `.parquet`, anything else is JSON Lines.
    """
    from rulec.trace.formats import format_of, read_chunks

    with opened(Path(path)) as stream:
        for chunk in read_chunks(stream, str(path), format_of(str(path))):
            yield from chunk


def judge_recording(
    recording: str | Path | Recording,
    rulebook: str | Path | Rulebook | CompiledRulebook | AnyStep,
    wanted: Wanted | None = None,
    net: str | Path | None = None,
) -> JudgedRecording:
    """What the vehicles of recorded traffic did, given by path or itself, judged by a rulebook.

    ``net`` is for SUMO's data. Raises RulecError.
    """
    from rulec.drives.judging import JudgedRecording
    from rulec.drives.wanted import Wanted
    from rulec.scenario.recordings import read_recording

    if isinstance(recording, str | Path):
        file = str(recording)
        recording = read_recording(Path(file), None if net is None else Path(net))
    else:
        file = recording.name
    return JudgedRecording(recording, machines(rulebook), wanted or Wanted(), file)


def read_past(path: Path) -> Before:
    """The one trace of a file, or a saved monitor's snapshot (.json). Raises RulecError."""
    from rulec.runtime.before import only_trace
    from rulec.runtime.online.file import read_saved

    if path.suffix == ".json":
        saved: Mapping[str, Any] = read_saved(path)
        return saved
    return only_trace(read_traces(path), Place(str(path)))


def navigation_graph(
    scenario: str | Path | Scenario,
    *,
    partition: PartitionName = "paper",
    adjacency: AdjacencyName = "touch",
    extent: ExtentName = "lane",
    step_s: float | None = None,
    horizon_s: float | None = None,
) -> NavigationGraph:
    """Partition a scenario, given by name, by path or itself, into cells and their graph.

    In a recorded scene the step, unless given, is the longest one that leaves ego a place to start.
    """
    from rulec.partition import navigation_graph as build
    from rulec.scenario import Scenario, load_scenario

    if not isinstance(scenario, Scenario):
        scenario = load_scenario(scenario)
    if step_s is None and scenario.account is not None:
        step_s = _longest_step(scenario, partition, extent, horizon_s)
    return build(
        scenario,
        partition=partition,
        adjacency=adjacency,
        extent=extent,
        step_s=step_s,
        horizon_s=horizon_s,
    )


def _longest_step(
    scenario: Scenario, partition: PartitionName, extent: ExtentName, horizon_s: float | None
) -> float | None:
    """The scenario's own step, or the half of it, and so on; None if none will do."""
    from rulec.partition.start import step_that_leaves_room
    from rulec.scenario.timing import timing

    times = timing(scenario.horizon_s if horizon_s is None else horizon_s, scenario.step_s)
    found = step_that_leaves_room(scenario, times, partition, extent)
    return None if found is None else float(found.step)


def find_maneuvers(
    scenario: str | Path | Scenario,
    rulebook: str | Path | Rulebook | CompiledRulebook | AnyStep,
    *,
    partition: PartitionName | None = None,
    adjacency: AdjacencyName = "touch",
    extent: ExtentName = "lane",
    step_s: float | None = None,
    horizon_s: float | None = None,
    after: Before | None = None,
) -> Maneuvers:
    """Algorithm 1 of the paper, counting instead of enumerating.

    ``partition``: the one whose relations the rulebook reads, unless given. ``after``: what was
    before, up to one step before the scenario begins: a trace, a ``Monitor`` that has taken one, or
    its snapshot. Raises RulecError.
    """
    rules = machines(rulebook)
    source = rules if isinstance(rules, CompiledRulebook) else rules.rulebook
    graph = navigation_graph(
        scenario,
        partition=partition_for(source, partition),
        adjacency=adjacency,
        extent=extent,
        step_s=step_s,
        horizon_s=horizon_s,
    )
    compiled = rules if isinstance(rules, CompiledRulebook) else rules(graph.step)
    return judged(graph, compiled, after)
