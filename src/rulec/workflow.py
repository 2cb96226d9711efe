"""The whole of rulec on one page.

    source text -> syntax -> rulebook -> logic -> automata -> runtime -> verdicts
    scenario -> partition -> graph of traces ----------------^

The command line and ``import rulec`` are thin layers over these functions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rulec.automata import compiled_file
from rulec.automata.compiled import CompiledRulebook
from rulec.diagnostics import Diagnostic, RulecError
from rulec.files import opened
from rulec.maneuvers import Maneuvers, judged, partition_for
from rulec.trace import Trace, json_lines

if TYPE_CHECKING:
    from rulec.partition import AdjacencyName, NavigationGraph, PartitionName
    from rulec.rulebook.model import Rulebook
    from rulec.runtime.examples import ExampleRun
    from rulec.scenario import Scenario


def load_rulebook(reference: str | Path, search_path: Sequence[str | Path] = ()) -> Rulebook:
    """A rulebook as meant, from its name or its source's path. Raises RulecError."""
    from rulec.rulebook.loader import load_rulebook as load

    return load(reference, [Path(folder) for folder in search_path])


def compile_rulebook(
    reference: str | Path | Rulebook | CompiledRulebook,
    search_path: Sequence[str | Path] = (),
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
) -> CompiledRulebook:
    """Compile a rulebook: given by name, by path (source or compiled), or itself.

    ``warn`` is told what is odd, but not wrong, in a source: an example that comes out otherwise
    than it says, for one.

    Raises:
        RulecError: with every mistake in the source, or why it cannot be compiled or read.
    """
    if isinstance(reference, CompiledRulebook):
        return reference
    if not isinstance(reference, str | Path):
        from rulec.automata.compiler import compile_rulebook as through_spot

        return through_spot(reference)
    if Path(reference).suffix == ".json":
        return compiled_file.read_compiled(Path(reference))
    from rulec.runtime.examples import surprise

    run = run_examples(reference, search_path)
    warn([*run.warnings, *(surprise(one) for one in run.outcomes if not one.passed)])
    return run.compiled


def run_examples(
    reference: str | Path, search_path: Sequence[str | Path] = (), pattern: str | None = None
) -> ExampleRun:
    """Compile a rulebook, given by name or by its source's path, and run its examples.

    ``pattern``: run only those whose ``RULE`` or ``RULE/LABEL`` it matches, ``*`` and ``?`` being
    wild. Raises RulecError like ``compile_rulebook``.
    """
    from rulec.automata.compiler import compile_rulebook as through_spot
    from rulec.rulebook.loader import read_rulebook
    from rulec.runtime.examples import run_all

    loaded = read_rulebook(reference, [Path(folder) for folder in search_path])
    return run_all(loaded.rulebook, through_spot(loaded.rulebook), loaded.warnings, pattern)


def read_traces(path: str | Path) -> Iterator[Trace | RulecError]:
    """The traces of a JSON Lines file one by one; in place of a bad one, what is wrong with it."""
    with opened(Path(path)) as stream:
        yield from json_lines.read_traces(stream, str(path))


def navigation_graph(
    scenario: str | Path | Scenario,
    *,
    partition: PartitionName = "paper",
    adjacency: AdjacencyName = "touch",
    step_s: float | None = None,
    horizon_s: float | None = None,
) -> NavigationGraph:
    """Partition a scenario, given by name, by path or itself, into cells and their graph."""
    from rulec.partition import navigation_graph as build
    from rulec.scenario import Scenario, load_scenario

    if not isinstance(scenario, Scenario):
        scenario = load_scenario(scenario)
    return build(
        scenario, partition=partition, adjacency=adjacency, step_s=step_s, horizon_s=horizon_s
    )


def find_maneuvers(
    scenario: str | Path | Scenario,
    rulebook: str | Path | Rulebook | CompiledRulebook,
    *,
    partition: PartitionName | None = None,
    adjacency: AdjacencyName = "touch",
    step_s: float | None = None,
    horizon_s: float | None = None,
) -> Maneuvers:
    """Algorithm 1 of the paper, counting instead of enumerating.

    ``partition``: the one whose relations the rulebook reads, unless given. Raises RulecError.
    """
    rules = compile_rulebook(rulebook)
    graph = navigation_graph(
        scenario,
        partition=partition_for(rules, partition),
        adjacency=adjacency,
        step_s=step_s,
        horizon_s=horizon_s,
    )
    return judged(graph, rules)
