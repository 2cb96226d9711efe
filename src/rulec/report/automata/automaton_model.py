"""A rule's automaton for readers: states, and transitions with conditions in words."""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import wrap
from typing import Literal

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.guards import edges
from rulec.diagnostics import SourceLocation
from rulec.report.text.terminal_text import counted, styled, table_lines, visible
from rulec.report.verdicts.guard_text import GuardWording
from rulec.vocabulary import Vocabulary

Fate = Literal["open", "violated", "satisfied"]
"""Whether the verdict is final in a state, and which one it is."""


@dataclass(frozen=True, slots=True)
class Transition:
    """Steps between two states; ``accepted`` is the verdict on a trace that ends with such a step.

    ``condition`` is the condition on the state of the world read; ``otherwise``: it is simpler to
    describe it as the rest after the other transitions from the source.
    """

    source: int
    target: int
    condition: str
    otherwise: bool
    accepted: bool

    @property
    def label(self) -> str:
        """The condition in its shortest form."""
        return "otherwise" if self.otherwise else self.condition


@dataclass(frozen=True, slots=True)
class Automaton:
    """States from 0, the initial one, with fates; transitions from the open states."""

    fates: tuple[Fate, ...]
    transitions: tuple[Transition, ...]


def automaton_of(
    rule: CompiledRule, vocabulary: Vocabulary, place: SourceLocation | None = None
) -> Automaton:
    """The automaton of a compiled rule. Raises RulecError as ``edges``, with the rule's place."""
    wording = GuardWording(rule, vocabulary)
    machine = rule.machine
    fates: dict[int | None, Fate] = {
        machine.rejecting_sink: "violated",
        machine.accepting_sink: "satisfied",
    }
    return Automaton(
        tuple(fates.get(state, "open") for state in range(len(machine.successors))),
        tuple(
            Transition(
                edge.source,
                edge.target,
                visible(wording.condition(edge.cubes)),
                edge.otherwise,
                edge.accepted,
            )
            for edge in edges(machine, f"rule `{rule.name}`", place)
        ),
    )


WORDS = {True: "accepted", False: "rejected"}

MOST_LINES = 6
"""A condition with more lines is cut after these, because it would not be read."""

_FINAL = {
    "violated": "violated for good: whatever follows, the trace is rejected",
    "satisfied": "satisfied for good: whatever follows, the trace is accepted",
}


def as_text(automaton: Automaton, width: int) -> str:
    """A paragraph per state; the last column is the verdict if the trace ends there."""
    head = f"{counted(len(automaton.fates), 'state')}; a trace starts in state 0"
    if automaton.transitions:
        head += ", and is accepted or rejected as written after its last step"
    lines = wrap(head, width)
    for state, fate in enumerate(automaton.fates):
        if fate != "open":
            final = wrap(f"state {state}: {_FINAL[fate]}", width, subsequent_indent="  ")
            lines += [styled(line, _COLORS[fate]) for line in final]
            continue
        lines.append(f"state {state}")
        lines += _leaving(
            [transition for transition in automaton.transitions if transition.source == state],
            state,
            width,
        )
    return "\n".join(lines)


_COLORS = {"violated": "red", "satisfied": "green"}


def _leaving(transitions: list[Transition], state: int, width: int) -> list[str]:
    ordered = sorted(transitions, key=lambda transition: transition.otherwise)
    targets = [
        "stays" if transition.target == state else f"to state {transition.target}"
        for transition in ordered
    ]
    label_width = max(20, width - 2 - max(map(len, targets)) - 3 - len("rejected") - 3)
    labels = [_broken(transition.label, label_width) for transition in ordered]
    rows = []
    for transition, target, (first, *rest) in zip(ordered, targets, labels, strict=True):
        rows += [(first, target, WORDS[transition.accepted]), *((line, "", "") for line in rest)]
    return table_lines(rows, indent="  ", gap="   ")


def _broken(label: str, label_width: int) -> list[str]:
    lines = wrap(label, label_width, subsequent_indent="  ")
    return lines if len(lines) <= MOST_LINES else [*lines[: MOST_LINES - 1], "  … (all: --json)"]


_WIDEST = 32
"""Width at which labels are wrapped, in characters."""

_DOT_NAMES: dict[Fate, str] = {
    "open": "{}",
    "violated": "{}\\nviolated\\nfor good",
    "satisfied": "{}\\nsatisfied\\nfor good",
}

_DOT_STYLES: dict[Fate, str] = {
    "open": "shape=circle",
    "violated": 'shape=octagon, style=filled, fillcolor="#f3c2a8"',
    "satisfied": 'shape=box, style="rounded,filled", fillcolor="#bcd9ee"',
}


def as_dot(automaton: Automaton, name: str) -> str:
    """A digraph in DOT; accepting edges are solid, rejecting ones dashed."""
    lines = [
        f"// {visible(name)}: a trace that ends with a dashed edge is rejected.",
        f'digraph "{_escaped(name)}" {{',
        "  rankdir=LR",
        '  node [fontname="sans-serif"]',
        '  edge [fontname="sans-serif", fontsize=11]',
        '  start [shape=point, width=0.1, label=""]',
        "  start -> 0",
    ]
    for state, fate in enumerate(automaton.fates):
        lines.append(f'  {state} [label="{_DOT_NAMES[fate].format(state)}", {_DOT_STYLES[fate]}]')
    for transition in automaton.transitions:
        style = "" if transition.accepted else ', style=dashed, color="#b34700"'
        label = "\\n".join(_escaped(line) for line in wrap(transition.label, _WIDEST))
        lines.append(f'  {transition.source} -> {transition.target} [label="{label}"{style}]')
    return "\n".join([*lines, "}"])


def _escaped(text: str) -> str:
    return visible(text).replace("\\", "\\\\").replace('"', '\\"')
