"""rulec, a compiler for traffic law: rulebooks in, automata out, every maneuver judged.

A look at all of it::

    import rulec

    rules = rulec.compile_rulebook("esterle2019")     # a name, a source path, a compiled file
    verdict = rulec.verify(trace, rules)              # a rulec.Trace; see rulec.read_traces
    graph = rulec.navigation_graph("s2", step_s=0.5)  # cells, adjacency; graph.to_networkx()
    found = rulec.find_maneuvers("s2", rules)         # counts, and the cheapest ones lazily

Whatever goes wrong with an input is a ``rulec.RulecError`` with the diagnostics as data.
Nothing is imported before it is used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from rulec.version import __version__

if TYPE_CHECKING:
    from rulec.api.workflow import compile_rulebook as compile_rulebook
    from rulec.api.workflow import find_maneuvers as find_maneuvers
    from rulec.api.workflow import navigation_graph as navigation_graph
    from rulec.api.workflow import verify_recording as verify_recording
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook as CompiledRulebook
    from rulec.diagnostics import RulecError as RulecError
    from rulec.monitoring.batch.batch_verify import verify_many as verify_many
    from rulec.monitoring.online.running_monitor import Monitor as Monitor
    from rulec.monitoring.verdict import Verdict as Verdict
    from rulec.monitoring.verify import verify as verify
    from rulec.partition import NavigationGraph as NavigationGraph
    from rulec.planning import Maneuvers as Maneuvers
    from rulec.rulebook.loader import load_rulebook as load_rulebook
    from rulec.rulebook.model import Rulebook as Rulebook
    from rulec.scenario import Scenario as Scenario
    from rulec.scenario import load_scenario as load_scenario
    from rulec.trace import Trace as Trace
    from rulec.trace.formats.trace_files import read_traces as read_traces

_HOME = {
    "CompiledRulebook": "rulec.automata.bundle.compiled_rulebook",
    "Maneuvers": "rulec.planning",
    "Monitor": "rulec.monitoring.online.running_monitor",
    "NavigationGraph": "rulec.partition",
    "Rulebook": "rulec.rulebook.model",
    "RulecError": "rulec.diagnostics",
    "Scenario": "rulec.scenario",
    "Trace": "rulec.trace",
    "Verdict": "rulec.monitoring.verdict",
    "compile_rulebook": "rulec.api.workflow",
    "find_maneuvers": "rulec.api.workflow",
    "verify_recording": "rulec.api.workflow",
    "load_rulebook": "rulec.rulebook.loader",
    "load_scenario": "rulec.scenario",
    "navigation_graph": "rulec.api.workflow",
    "read_traces": "rulec.trace.formats.trace_files",
    "verify": "rulec.monitoring.verify",
    "verify_many": "rulec.monitoring.batch.batch_verify",
}

__all__ = ["__version__", *_HOME]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'rulec' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
