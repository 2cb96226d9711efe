"""Rules, graphs, maneuvers and recordings from whatever they are given by.

    source text -> syntax -> rulebook -> logic -> automata -> monitoring -> verdicts
    scenario -> partition -> graph of traces ------------------^

The command line and a session are thin layers over these functions, of which each raises
RulecError for what is wrong with its input.
"""

# Imports within functions: what all of them need takes 330 ms, this module alone 20 ms.

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import Diagnostic

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rulec.extraction.recording_verdicts import RecordingVerdicts
    from rulec.extraction.selection.requested import RequestedDrives
    from rulec.partition import GraphOptions, NavigationGraph
    from rulec.planning import Maneuvers
    from rulec.planning.trace_history import Before
    from rulec.rulebook.rulebook_model import Rulebook
    from rulec.scenario import Scenario
    from rulec.scenario.recorded.recording import Recording

    Rules: TypeAlias = str | Path | Rulebook | CompiledRulebook
    """A name, a path of a source or of a compiled file (.json), or what these lead to."""


def machines(
    rules: Rules,
    search_path: Sequence[str | Path] = (),
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
    at: str = "",
) -> CompiledRulebook:
    """Compile rules into automata that adapt to any trace's step.

    ``warn`` is told what is odd, but not wrong, in a source: an example that comes out otherwise
    than it says, for one. ``at`` is the day (ISO) whose law it is; if empty, that of the rulebook's
    `law` line or else today.
    """
    if isinstance(rules, CompiledRulebook):
        return rules
    if isinstance(rules, str | Path):
        if Path(rules).suffix == ".json":
            from rulec.automata.bundle.bundle_file import read_compiled

            return read_compiled(Path(rules))
        from rulec.pipeline import compile_source

        return compile_source(rules, search_path, at, any_step=True, on_warning=warn)
    from rulec.automata.compiler import lower
    from rulec.automata.step_compilation import StepCompiler, build_automata

    return build_automata(lower(rules, any_step=True), StepCompiler(rules))


def compile_rulebook(
    reference: Rules,
    search_path: Sequence[str | Path] = (),
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
    step_s: Fraction | float | None = None,
    at: str = "",
) -> CompiledRulebook:
    """Compile rules for one step, or for that of their examples.

    ``step_s`` (above 0, a float meaning the decimal that is written) is that step; without it rules
    with bounds in seconds are compiled for the step of their own examples. R0407 for a bound that
    is no multiple of the step, R0507 if the rules have been compiled for another one.
    """
    from rulec.automata.thresholds import exact

    step = None if step_s is None else exact(step_s)
    if isinstance(reference, CompiledRulebook) or (
        isinstance(reference, str | Path) and Path(reference).suffix == ".json"
    ):
        compiled = machines(reference)
        return compiled if step is None else compiled.at_step(step)
    if isinstance(reference, str | Path):
        from rulec.pipeline import compile_source

        return compile_source(reference, search_path, at, step, on_warning=warn)
    from rulec.automata.compiler import lower
    from rulec.automata.step_compilation import StepCompiler, build_automata

    return build_automata(lower(reference, step), StepCompiler(reference))


def navigation_graph(
    scenario: str | Path | Scenario, **options: Unpack[GraphOptions]
) -> NavigationGraph:
    """Partition a scenario, given by name, by path or itself."""
    from rulec.partition import navigation_graph as partitioned
    from rulec.scenario import Scenario, load_scenario

    scene = scenario if isinstance(scenario, Scenario) else load_scenario(scenario)
    return partitioned(scene, **options)


def find_maneuvers(
    scenario: str | Path | Scenario,
    rulebook: Rules,
    *,
    after: Before | None = None,
    **options: Unpack[GraphOptions],
) -> Maneuvers:
    """Count the maneuvers that keep every hard rule (the paper's algorithm 1).

    ``after``: what was before, up to one step before the scenario begins: a trace, a ``Monitor``
    that has taken one, or its snapshot. Without a ``partition`` it is the one whose relations the
    rulebook reads.
    """
    from rulec.planning import evaluate, partition_for

    rules = machines(rulebook)
    options["partition"] = partition_for(rules, options.get("partition"))
    return evaluate(navigation_graph(scenario, **options), rules, after)


def verify_recording(
    recording: str | Path | Recording,
    rulebook: Rules,
    wanted: RequestedDrives | None = None,
    net: str | Path | None = None,
) -> RecordingVerdicts:
    """Judge the drives of recorded vehicles; ``net`` is for SUMO's data."""
    from rulec.extraction.recording_verdicts import RecordingVerdicts
    from rulec.extraction.selection.requested import RequestedDrives
    from rulec.scenario.recording_files import read_recording

    file = recording if isinstance(recording, str | Path) else recording.name
    if isinstance(recording, str | Path):
        recording = read_recording(Path(recording), None if net is None else Path(net))
    return RecordingVerdicts(recording, machines(rulebook), wanted or RequestedDrives(), str(file))
