"""Machines for traces that are cut, as a compiled rulebook's file has them."""

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
    """The tables of a rule's machine for traces that are cut, as ``OutcomeMachine`` has them."""

    letters: tuple[int, ...]
    successors: tuple[tuple[int, ...], ...]
    outputs: tuple[tuple[int, ...], ...]
    starts: tuple[int, ...]


_MADE: dict[tuple[int, int], tuple[CutTables, MealyMonitor, OutcomeMachine]] = {}
_MOST_MADE = 1 << 10


@dataclass(frozen=True, slots=True)
class StoredPrefixes:
    """A ``PrefixCompiler`` of machines that have been stored, by the rule's name.

    ``orders`` are those of their states, as far as they have been stored, too.
    """

    entries: Mapping[str, CutTables | None]
    orders: Mapping[str, bytes] = field(default_factory=dict)

    def __call__(self, rulebook: CompiledRulebook) -> Mapping[str, OutcomeMachine | None]:
        """The machines of the rulebook's rules; None where one would have got too large."""
        # numpy, a tenth of a second, is loaded only where a trace is cut.
        from rulec.automata.outcome_machine import OutcomeMachine

        machines: dict[str, OutcomeMachine | None] = {}
        for rule in rulebook.rules:
            entry = self.entries.get(rule.name)
            machines[rule.name] = None
            if entry is not None:
                # Rules that read different things may have the same tables.
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
    """What a file can store; None if nobody can compile machines for cut traces.

    Raises RulecError R0403 if that takes Spot, and it is not installed.
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
