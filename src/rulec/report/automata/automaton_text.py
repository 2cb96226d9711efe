"""A rule's automaton as lines of text."""

from __future__ import annotations

from textwrap import wrap

from rulec.report.automata.automaton_model import Automaton, Transition
from rulec.report.text.terminal_text import styled, table_lines

WORDS = {True: "accepted", False: "rejected"}

MOST_LINES = 6
"""Of a condition that takes more lines only the beginning is shown: nobody would read it."""

_FINAL = {
    "violated": "violated for good: whatever follows, the trace is rejected",
    "satisfied": "satisfied for good: whatever follows, the trace is accepted",
}


def as_text(automaton: Automaton, width: int) -> str:
    """A paragraph per state; the last column is the verdict at end."""
    number = len(automaton.fates)
    head = f"{number:,} {'state' if number == 1 else 'states'}; a trace starts in state 0"
    if automaton.transitions:
        head += ", and is accepted or rejected as it says behind its last step"
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
    ordered = [transition for transition in transitions if not transition.otherwise]
    ordered += [transition for transition in transitions if transition.otherwise]
    targets = [
        "stays" if transition.target == state else f"to state {transition.target}"
        for transition in ordered
    ]
    room = max(20, width - 2 - max(map(len, targets)) - 3 - len("rejected") - 3)
    labels = [_broken(transition.label, room) for transition in ordered]
    rows = []
    for transition, target, (first, *rest) in zip(ordered, targets, labels, strict=True):
        rows += [(first, target, WORDS[transition.accepted]), *((line, "", "") for line in rest)]
    return table_lines(rows, indent="  ", gap="   ")


def _broken(label: str, room: int) -> list[str]:
    lines = wrap(label, room, subsequent_indent="  ")
    return lines if len(lines) <= MOST_LINES else [*lines[: MOST_LINES - 1], "  … (all: --json)"]
