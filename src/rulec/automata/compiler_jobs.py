"""Jobs of the compilers, one a rule, and their answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from rulec.automata.axiom_groups import AxiomGroup
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read
from rulec.automata.tables import DeterministicAutomaton
from rulec.logic.formula import Formula
from rulec.logic.semantics import Semantics
from rulec.rulebook.rules.axiom_instances import AxiomInstance

MOST_LETTERS = 1 << 16
MOST_STEPS_AHEAD = 10_000
"""An automaton has a state for each step of a bound, at least; no more can be built in time."""


@dataclass(frozen=True, slots=True)
class Job:
    """One rule to translate, its bounds in steps.

    ``groups`` are the facts that hold of its variables. ``cpu_s``: the processor time it may use,
    in whole seconds.
    """

    name: str
    formula: Formula
    reads: tuple[Read | NumberRead, ...]
    remarks: tuple[str, ...]
    semantics: Semantics
    groups: tuple[AxiomGroup, ...]
    cpu_s: int
    most_letters: int = MOST_LETTERS

    def remarks_on(self, alive: str | None) -> tuple[str, ...]:
        """What its automaton's text says; a finite word ends where ``alive`` gets false."""
        if alive is None:
            return self.remarks
        return *self.remarks, f'finite words: "{alive}" is true as long as the word lasts'


@dataclass(frozen=True, slots=True)
class Done:
    """A rule's machine, and its automaton in HOA."""

    machine: MealyMonitor
    hoa: str


@dataclass(frozen=True, slots=True)
class Failed:
    """Reason for no monitor.

    ``letters``, ``steps``, ``sets`` (of acceptance) or ``memory``: there would be too many, or too
    much. ``check``: it was wrong. ``facts``: those of ``contradiction`` cannot hold together.
    ``reach``: it takes Spot. ``time``: those before it took all that a rulebook has. ``bug`` is
    anything that nobody thought of, with the traceback.
    """

    why: Literal["letters", "steps", "sets", "memory", "check", "facts", "reach", "time", "bug"]
    traceback: str = ""
    contradiction: tuple[AxiomInstance, ...] = ()


@dataclass(frozen=True, slots=True)
class Translated:
    """A rule's automaton over its letters, and as a text in HOA.

    ``possible`` are the letters that facts leave, as bits, None for all of them. ``is_checked``:
    the automaton has been compared with the formula. Where that takes long ``compare`` does so, as
    far as it gets; it raises CheckError.
    """

    automaton: DeterministicAutomaton
    possible: int | None
    hoa: str
    is_checked: bool = False
    compare: Callable[[], None] | None = None


class CheckError(Exception):
    """An automaton does not have its formula's language."""


class BeyondReachError(Exception):
    """A formula that a compiler has no way to translate."""


class AcceptanceError(Exception):
    """An automaton takes more acceptance sets than a compiler has."""


Translator: TypeAlias = Callable[[Job], Translated]
"""Raises CheckError, BeyondReachError and AcceptanceError."""


@dataclass(frozen=True, slots=True)
class Compiler:
    """A compiler: its ``version``, and what it is asked.

    ``contradicts`` tells of a formula without temporal operators whether it holds in no state.
    """

    version: str
    translate: Translator
    contradicts: Callable[[Formula], bool]
