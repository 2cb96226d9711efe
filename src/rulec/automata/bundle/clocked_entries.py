"""Tables in a compiled rulebook's file: their checks, and machines for any step."""

from __future__ import annotations

from itertools import chain
from math import prod
from typing import Any, TypeAlias

from rulec.automata import mealy_monitor as monitors
from rulec.automata.bundle import bundle_schema as schema
from rulec.automata.clocks.clocked_machine import ClockedMachine, ClockLetters, TimedMachine
from rulec.automata.compiler_jobs import MOST_LETTERS
from rulec.logic.bounds import range_of_bound
from rulec.logic.codec import number_from_data
from rulec.logic.formula import Bound

Reads: TypeAlias = tuple[monitors.Read | monitors.NumberRead, ...]


def clocked_entry(timed: TimedMachine | None) -> schema.ClockedEntry | None:
    """The entry of a machine for any step, if there is one."""
    if timed is None:
        return None
    clocked, table = timed.clocked, timed.clocked.table
    # Codes are 0 to 3 and steps 0 or 1, as the schema requires.
    rows: Any = clocked.clocks.operands
    clocks = [
        schema.ClockEntry(
            low=str(bound.low),
            high=None if bound.high is None else str(bound.high),
            unit=bound.unit,
            operands=operands,
            early=bound.early,
            least=1 if bound.least else 0,
        )
        for bound, operands in zip(timed.bounds, rows, strict=True)
    ]
    return schema.ClockedEntry(
        groups=clocked.groups,
        clocks=clocks,
        letters=table.letters,
        successors=table.successors,
        outputs=table.outputs,
        rejecting_sink=table.rejecting_sink,
        accepting_sink=table.accepting_sink,
    )


def timed_machine(
    read: schema.ClockedEntry, reads: Reads, rule: str, *, ends: bool
) -> TimedMachine:
    """The machine for any step of an entry, over such reads. ValueError if it is not sound."""
    n_groups = max(read.groups, default=monitors.IMPOSSIBLE) + 1
    n_letters = n_groups << len(read.clocks)
    require(n_letters <= MOST_LETTERS, f"rule `{rule}` has too many clocks")
    check_table(read, n_letters, rule)
    check_sinks(read, rule)
    bounds = [_bound(clock) for clock in read.clocks]
    fits: list[bool] = [
        n_groups > 0,
        len(read.groups) == prod(item.size for item in reads),
        min(read.groups, default=0) >= monitors.IMPOSSIBLE,
        all(len(clock.operands) == n_letters for clock in read.clocks),
        all(end is None or end >= 0 for bound in bounds for end in (bound.low, bound.high)),
    ]
    require(all(fits), f"the clocks of rule `{rule}` have a row or number that does not fit")
    table = monitors.MealyMonitor(
        (),
        read.letters,
        read.successors,
        read.outputs,
        rejecting_sink=read.rejecting_sink,
        accepting_sink=read.accepting_sink,
    )
    clocks = ClockLetters(n_groups, tuple([clock.operands for clock in read.clocks]))
    met = [read.letters[letter] for letter in clocks.possible(bounds)]
    require(min(met) >= 0, f"the clocks of rule `{rule}` lead to letters without a class")
    return TimedMachine(ClockedMachine(reads, read.groups, clocks, table), tuple(bounds), ends)


def _bound(read: schema.ClockEntry) -> Bound:
    high = None if read.high is None else number_from_data(read.high)
    low, least = number_from_data(read.low), read.least
    bound = Bound(low, high, read.unit, early=read.early, least=least)
    if bound.unit == "steps":
        range_of_bound(bound)  # whole numbers
    return bound


def check_sinks(read: schema.MachineEntry | schema.ClockedEntry, rule: str) -> None:
    """Raise ValueError unless a table names its dead and its safe state."""
    traps = [
        monitors.sink_of(read.successors, read.outputs, verdict=verdict)
        for verdict in (False, True)
    ]
    require(
        traps == [read.rejecting_sink, read.accepting_sink],
        f"rule `{rule}` names a wrong dead or safe state",
    )


def check_table(
    read: schema.MachineEntry | schema.CutMachineEntry | schema.ClockedEntry,
    n_letters: int,
    rule: str,
) -> None:
    """Raise ValueError unless a table is complete, over so many letters."""
    n_states = len(read.successors)
    n_classes = len(read.successors[0]) if read.successors else 0
    fits: list[bool] = [
        n_states > 0,
        len(read.letters) == n_letters,
        min(read.letters, default=0) >= monitors.IMPOSSIBLE,
        max(read.letters, default=0) < n_classes,
        all(len(row) == n_classes for row in read.successors),
        all(len(row) == n_classes for row in read.outputs),
        len(read.outputs) == n_states,
        all(0 <= state < n_states for state in chain.from_iterable(read.successors)),
    ]
    require(all(fits), f"the table of rule `{rule}` has a row or number that does not fit")


def require(condition: bool, problem: str) -> None:
    """Raise ValueError unless a condition holds."""
    if not condition:
        raise ValueError(problem)
