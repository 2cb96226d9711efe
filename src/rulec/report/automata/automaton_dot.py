"""A rule's automaton in the language of Graphviz."""

from __future__ import annotations

from textwrap import wrap

from rulec.report.automata.automaton_model import Automaton, Fate
from rulec.report.text.terminal_text import visible

WIDEST = 32
"""Labels are broken at so many characters."""

_NAMES: dict[Fate, str] = {
    "open": "{}",
    "violated": "{}\\nviolated\\nfor good",
    "satisfied": "{}\\nsatisfied\\nfor good",
}

_STYLES: dict[Fate, str] = {
    "open": "shape=circle",
    "violated": 'shape=octagon, style=filled, fillcolor="#f3c2a8"',
    "satisfied": 'shape=box, style="rounded,filled", fillcolor="#bcd9ee"',
}


def as_dot(automaton: Automaton, name: str) -> str:
    """A digraph in DOT; accepting edges are solid, rejecting ones dashed."""
    lines = [
        f"// {visible(name)}: a trace that ends with a dashed edge is rejected.",
        f"digraph {_quoted(name)} {{",
        "  rankdir=LR",
        '  node [fontname="sans-serif"]',
        '  edge [fontname="sans-serif", fontsize=11]',
        '  start [shape=point, width=0.1, label=""]',
        "  start -> 0",
    ]
    for state, fate in enumerate(automaton.fates):
        lines.append(f'  {state} [label="{_NAMES[fate].format(state)}", {_STYLES[fate]}]')
    for transition in automaton.transitions:
        style = "" if transition.accepted else ', style=dashed, color="#b34700"'
        label = "\\n".join(_escaped(line) for line in wrap(transition.label, WIDEST))
        lines.append(f'  {transition.source} -> {transition.target} [label="{label}"{style}]')
    return "\n".join([*lines, "}"])


def _quoted(text: str) -> str:
    return f'"{_escaped(text)}"'


def _escaped(text: str) -> str:
    return visible(text).replace("\\", "\\\\").replace('"', '\\"')
