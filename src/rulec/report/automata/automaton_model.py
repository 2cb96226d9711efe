"""A rule's automaton for readers: states, and transitions with conditions in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.guards import edges
from rulec.diagnostics import SourceLocation
from rulec.report.text.terminal_text import visible
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
