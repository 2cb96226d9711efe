"""The compilers' jobs, one for each rule, and their answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias

from rulec.automata.alphabet import propositions_of
from rulec.automata.axiom_groups import AxiomGroup
from rulec.automata.clocks.clocked_machine import TimedMachine
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read
from rulec.automata.tables import DeterministicAutomaton
from rulec.logic.bounds import in_steps
from rulec.logic.formula import Formula, Proposition
from rulec.logic.past_registers import Clock
from rulec.logic.semantics import Semantics
from rulec.rulebook.rules.axiom_instances import AxiomInstance

MOST_LETTERS = 1 << 16

MOST_OPERATORS = 1_000_000
"""The most of a formula in which each `then` is written out, which says its left operand twice."""


@dataclass(frozen=True, slots=True)
class Job:
    """One rule to translate, for steps of ``step_s`` seconds if it has bounds in seconds.

    ``groups`` are the axioms about its variables. Without ``remarks`` no text of the automaton is
    wanted. With ``clocks``, which have no bounds, the formula speaks of them, and of the present
    and the future only, and ``named`` are the rule's propositions; None if it is translated as a
    whole.
    """

    name: str
    formula: Formula
    reads: tuple[Read | NumberRead, ...]
    remarks: tuple[str, ...]
    semantics: Semantics
    groups: tuple[AxiomGroup, ...]
    most_letters: int = MOST_LETTERS
    step_s: Fraction | None = None
    clocks: tuple[Clock, ...] | None = None
    named: tuple[Proposition, ...] | None = None

    @property
    def in_steps(self) -> Formula:
        """The formula with its bounds in steps."""
        return self.formula if self.step_s is None else in_steps(self.formula, self.step_s)

    @property
    def propositions(self) -> tuple[Proposition, ...]:
        """The propositions of the rule."""
        return propositions_of(self.formula) if self.named is None else self.named

    def comments(self, alive: str | None) -> list[str]:
        """The remarks for the automaton's text; a finite word ends when ``alive`` is false."""
        remarks = list(self.remarks)
        if alive is not None:
            remarks.append(f'finite words: "{alive}" is true as long as the word lasts')
        texts = [" ".join(x.replace("*/", "* /").replace("/*", "/ *").split()) for x in remarks]
        return [f"/* {text} */" for text in texts]


@dataclass(frozen=True, slots=True)
class Done:
    """A rule's machine, and its automaton in HOA if that is wanted.

    ``timed`` is the machine for any step, if there is one.
    """

    machine: MealyMonitor
    hoa: str
    timed: TimedMachine | None = field(default=None, compare=False)


FailedWhy: TypeAlias = Literal[
    "letters", "steps", "size", "sets", "memory", "check", "facts", "reach", "apart", "time", "bug"
]


@dataclass(frozen=True, slots=True)
class Failed:
    """The reason why there is no monitor.

    ``letters``, ``steps``, ``size`` (states, edges, operators), ``sets`` (of acceptance) or
    ``memory``: too many or too much is needed. ``check``: the result was wrong. ``facts``: those
    in ``contradiction`` cannot hold together. ``reach``: Spot is needed. ``apart``: it has to be
    translated as a whole. ``time``: the rulebook's time is used up. ``bug``: any unforeseen error,
    with its traceback.
    """

    why: FailedWhy
    traceback: str = ""
    contradiction: tuple[AxiomInstance, ...] = ()


@dataclass(frozen=True, slots=True)
class Translated:
    """A rule's automaton over its letters, and as HOA text.

    ``possible`` is the bit set of the letters that facts allow, None for all. ``is_checked``: the
    automaton has been compared with the formula. If that would take long, ``compare`` does it as
    far as its time allows, and raises CheckError.
    """

    automaton: DeterministicAutomaton
    possible: int | None
    hoa: str
    is_checked: bool = False
    compare: Callable[[], None] | None = None


class CheckError(Exception):
    """An automaton does not have the language of its formula."""


class BeyondReachError(Exception):
    """A formula that a compiler cannot translate."""


class AcceptanceError(Exception):
    """An automaton needs more acceptance sets than a compiler supports."""


Translator: TypeAlias = Callable[[Job], Translated]
"""Raises CheckError, BeyondReachError, SizeError and AcceptanceError."""


@dataclass(frozen=True, slots=True)
class Compiler:
    """A compiler: its ``version`` and its functions.

    ``contradicts`` returns whether a formula without temporal operators holds in no state. Some
    can translate the ``rest`` of a job's formula, once its past is in registers; it is given with
    the letters of each proposition, as bits, and their number. ``possible`` are then the letters
    that the facts allow, as bits, None for all.
    """

    version: str
    translate: Translator
    contradicts: Callable[[Formula], bool]
    rest: Callable[[Job, Formula, Mapping[Proposition, int], int], Translated] | None = None
    possible: Callable[[Job], int | None] = lambda _: None
