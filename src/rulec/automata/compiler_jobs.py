"""Jobs of the compilers, one a rule, and their answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Literal, TypeAlias

from rulec.automata.alphabet import count_letters
from rulec.automata.axiom_instances import AxiomGroup, AxiomInstance
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read
from rulec.automata.random_words import agrees
from rulec.automata.tables import DeterministicAutomaton, build_machine
from rulec.logic.bounds import operations_of
from rulec.logic.formula import Formula
from rulec.logic.semantics import Semantics

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

    ``letters``, ``steps`` or ``memory``: there would be too many, or too much. ``check``: it was
    wrong. ``facts``: those of ``contradiction`` cannot hold together. ``reach``: it takes Spot.
    ``bug`` is anything that nobody thought of, with the traceback.
    """

    why: Literal["letters", "steps", "memory", "check", "facts", "reach", "bug"]
    traceback: str = ""
    contradiction: tuple[AxiomInstance, ...] = ()


@dataclass(frozen=True, slots=True)
class Translated:
    """A rule's automaton over its letters, and as a text in HOA.

    ``possible`` are the letters that facts leave, as bits, None for all of them. ``is_checked``:
    the automaton has been compared with the formula.
    """

    automaton: DeterministicAutomaton
    possible: int | None
    hoa: str
    is_checked: bool


class CheckError(Exception):
    """An automaton does not have its formula's language."""


class BeyondReachError(Exception):
    """A formula that a compiler has no way to translate."""


Translator: TypeAlias = Callable[[Job], Translated]
"""Raises CheckError, and BeyondReachError."""


@dataclass(frozen=True, slots=True)
class Compiler:
    """A compiler: its ``version``, and what it is asked.

    ``contradicts`` tells of a formula without temporal operators whether it holds in no state.
    """

    version: str
    translate: Translator
    contradicts: Callable[[Formula], bool]


def answer_to(job: Job, compiler: Compiler) -> Done | Failed:
    """The machine of a job, or why there is none."""
    if count_letters(job.reads) > job.most_letters:
        return Failed("letters")
    if _farthest_step(job.formula) > MOST_STEPS_AHEAD:
        return Failed("steps")
    for group in job.groups:
        if compiler.contradicts(group.known):
            return Failed("facts", contradiction=_contradiction(group, compiler))
    try:
        found = compiler.translate(job)
    except CheckError:
        return Failed("check")
    except BeyondReachError:
        return Failed("reach")
    machine = build_machine(found.automaton, job.reads, found.possible)
    if not found.is_checked and not agrees(machine, job.formula, job.semantics):
        return Failed("check")
    return Done(machine, found.hoa)


def _farthest_step(formula: Formula) -> Fraction:
    """The last step that a bound of a formula in steps names."""
    bounds = [operation.bound for operation in operations_of(formula)]
    ends = [bound.high or bound.low for bound in bounds if bound is not None]
    return max(ends, default=Fraction(0))


def _contradiction(group: AxiomGroup, compiler: Compiler) -> tuple[AxiomInstance, ...]:
    needed = group
    for instance in group.instances:
        without = tuple(other for other in needed.instances if other is not instance)
        fewer = replace(needed, instances=without)
        if compiler.contradicts(fewer.known):
            needed = fewer
    return needed.instances
