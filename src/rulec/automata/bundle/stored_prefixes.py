"""Machines for cut traces, as stored in a compiled rulebook's file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.cut_machines import TimedCut
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
    too. ``timed`` says what the machines are made of at any step: where there is no entry.
    """

    entries: Mapping[str, CutTables | None]
    orders: Mapping[str, bytes] = field(default_factory=dict)
    timed: Mapping[str, TimedCut] = field(default_factory=dict)
    _made: dict[str, OutcomeMachine | None] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def __call__(self, rulebook: CompiledRulebook) -> Mapping[str, OutcomeMachine | None]:
        """The machines of the rulebook's rules; None for each that would have been too large."""
        return {rule.name: self._machine(rule) for rule in rulebook.rules}

    def at_other_steps(self, rules: Iterable[CompiledRule]) -> StoredPrefixes:
        """The machines at other steps of some rules."""
        gone = {rule.name for rule in rules}
        entries = {name: entry for name, entry in self.entries.items() if name not in gone}
        return StoredPrefixes(entries, self.orders, self.timed)

    def _machine(self, rule: CompiledRule) -> OutcomeMachine | None:
        entry, timed = self.entries.get(rule.name), self.timed.get(rule.name)
        if rule.name in self.entries or timed is None:
            return None if entry is None else _made(entry, rule, self.orders.get(rule.name))
        if rule.name not in self._made:
            self._made[rule.name] = timed.if_small(rule)
        return self._made[rule.name]


def _made(entry: CutTables, rule: CompiledRule, order: bytes | None) -> OutcomeMachine:
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
            order=order,
        )
        known = _MADE[key] = entry, rule.machine, machine
    return known[2]


def stored(
    rulebook: CompiledRulebook,
    timed: Callable[[CompiledRulebook], Mapping[str, TimedCut]] = lambda _: {},
) -> StoredPrefixes | None:
    """The machines that a file can store; None if no compiler for cut traces is available.

    Once they have been made, ``timed`` says what they are made of at any step.
    Raises RulecError R0403 if that needs Spot, and it is not installed.
    """
    if rulebook.prefixes is None or isinstance(rulebook.prefixes, StoredPrefixes):
        return rulebook.prefixes
    machines = rulebook.prefixes(rulebook)
    entries = {name: _entry(machine) for name, machine in machines.items()}
    orders = {name: _order(machine) for name, machine in machines.items() if machine is not None}
    return StoredPrefixes(entries, orders, timed(rulebook))


def _order(machine: OutcomeMachine) -> bytes:
    width = (len(machine.successors) + 7) // 8
    return b"".join([above.to_bytes(width, "little") for above in machine.above])


def _entry(machine: OutcomeMachine | None) -> CutTables | None:
    if machine is None:
        return None
    successors, outputs = tuple(map(tuple, machine.successors)), tuple(map(tuple, machine.outputs))
    return CutTables(machine.letters, successors, outputs, tuple(sorted(machine.starts)))
