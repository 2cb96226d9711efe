"""The input of benchmarks of many traces: the 75,441 maneuvers of scenario S2 at 0.5 s."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import rulec
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.logic.formula import Atom, atoms_of
from rulec.trace import Trace
from rulec.trace.trace_columns import TraceCells, layout_of
from rulec.trace.trace_model import paths

PEDESTRIAN = "ffflfll"
"""Where the pedestrian is, seen from each node of a layer."""


def maneuvers() -> TraceCells:
    """Walks through the graph's nodes, of which there are as many in each layer.

    The scenario has no pedestrian; one stands at the crossing, so that R3 speaks of somebody.
    """
    graph = rulec.navigation_graph("s2", step_s=0.5).trace_graph()
    nodes = np.array(list(paths(graph)), dtype=np.uint8)
    states = [
        {**state, "position": {**state["position"], "p1": PEDESTRIAN[node]}}
        for node, state in enumerate(graph.states[0])
    ]
    layout = layout_of([nodes.shape[1]] * len(nodes))
    objects = {**graph.objects, "p1": "pedestrian"}
    return TraceCells(layout, nodes.T.ravel().copy(), tuple(states), objects, step_s=graph.step_s)


def trace_at(cells: TraceCells, number: int) -> Trace:
    """One of the traces by itself."""
    word = cells.cells[number :: cells.layout.n_traces]
    states = tuple(cells.states[cell] for cell in word)
    return Trace(str(number), cells.step_s, cells.objects, states)


def sample_of(cells: TraceCells, every: int) -> list[Trace]:
    """Every so many traces."""
    return [trace_at(cells, number) for number in range(0, cells.layout.n_traces, every)]


def atoms_and_items(rules: CompiledRulebook, objects) -> dict[Atom, str]:
    """The rules' atoms, each with the object that its rule's variable stands for."""
    return {
        atom: name
        for rule in rules.rules
        for name, kind in objects.items()
        if kind == rule.variables[0].type
        for atom in atoms_of(rule.formula)
    }


def is_true(atom: Atom, state, item: str) -> bool:
    """Does an atom of a rule about one object hold?"""
    value = state.get(atom.name, False)
    value = value[item] if atom.arguments else value
    return value is True if atom.value is None else value == atom.value


def booleans_of(rules: CompiledRulebook, cells: TraceCells) -> dict[Atom, NDArray[np.bool_]]:
    """A column of Booleans for each atom of the rules."""
    return {
        atom: np.array([is_true(atom, state, item) for state in cells.states]).take(cells.cells)
        for atom, item in atoms_and_items(rules, cells.objects).items()
    }


def words_in_spot(rules: CompiledRulebook, traces: list[Trace]) -> Iterator[str]:
    """The words that the rules read of traces; a word's last letter goes on for ever."""
    for trace in traces:
        letters = [
            " & ".join(
                ("" if is_true(atom, state, item) else "!") + f'"{atom}"'
                for atom, item in atoms_and_items(rules, trace.objects).items()
            )
            for state in trace.states
        ]
        yield "; ".join([*letters[:-1], f"cycle{{{letters[-1]}}}"])
