"""Machines for cut traces, as stored in a compiled rulebook's file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.automata.mealy_monitor import MealyMonitor
    from rulec.automata.outcome_machine import OutcomeMachine


@dataclass(frozen=True, slots=True, eq=False)
class CutTables:
    """The tables of a rule's machine for cut traces, as in ``OutcomeMachine``."""

    letters: tuple[int, ...]
    successors: tuple[tuple[int, ...], ...]
    outputs: tuple[tuple[int, ...], ...]
    starts: tuple[int, ...]


_MADE: dict[tuple[int, int], tuple[CutTables, MealyMonitor, OutcomeMachine]] = {}
_MOST_MADE = 1 << 10


@dataclass(frozen=True, slots=True)
class StoredPrefixes:
    """A ``PrefixCompiler`` of stored machines, by the rule's name.

    ``orders`` are the orders of their states (``OutcomeMachine.order``), where these are stored,
    too.
    """

    entries: Mapping[str, CutTables | None]
    orders: Mapping[str, bytes] = field(default_factory=dict)

    def __call__(self, rulebook: CompiledRulebook) -> Mapping[str, OutcomeMachine | None]:
        """The machines of the rulebook's rules; None for each that would have been too large."""
        # NumPy takes 0.1 s to import: only if a trace is cut.
        from rulec.automata.outcome_machine import OutcomeMachine

        machines: dict[str, OutcomeMachine | None] = {}
        for rule in rulebook.rules:
            entry = self.entries.get(rule.name)
            machines[rule.name] = None
            if entry is not None:
                # Rules that read different signals may have the same tables.
                key = id(entry), id(rule.machine)
                known = _MADE.get(key)
                if known is None or known[0] is not entry or known[1] is not rule.machine:
                    if len(_MADE) >= _MOST_MADE:
                        _MADE.clear()
                    machine = OutcomeMachine(
                        rule.machine.reads,
                        entry.letters,
                        entry.successors,
                        entry.outputs,
                        frozenset(entry.starts),
                        order=self.orders.get(rule.name),
                    )
                    known = _MADE[key] = entry, rule.machine, machine
                machines[rule.name] = known[2]
        return machines


def stored(rulebook: CompiledRulebook) -> StoredPrefixes | None:
    """The machines that a file can store; None if no compiler for cut traces is available.

    Raises RulecError R0403 if that needs Spot, and it is not installed.
    """
    if rulebook.prefixes is None or isinstance(rulebook.prefixes, StoredPrefixes):
        return rulebook.prefixes
    machines = rulebook.prefixes(rulebook)
    entries = {name: _entry(machine) for name, machine in machines.items()}
    orders = {name: _order(machine) for name, machine in machines.items() if machine is not None}
    return StoredPrefixes(entries, orders)


def _order(machine: OutcomeMachine) -> bytes:
    width = (len(machine.successors) + 7) // 8
    return b"".join([above.to_bytes(width, "little") for above in machine.above])


def _entry(machine: OutcomeMachine | None) -> CutTables | None:
    if machine is None:
        return None
    successors, outputs = tuple(map(tuple, machine.successors)), tuple(map(tuple, machine.outputs))
    return CutTables(machine.letters, successors, outputs, tuple(sorted(machine.starts)))
