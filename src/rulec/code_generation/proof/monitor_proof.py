"""Proof of a monitor in C against the tables that it was made from.

Tables are compared entirely: their numbers, the class of every letter of every rule, and the step
from every state by every class, both as the only possible class and as one of several. Readings are
tested below, at and above each limit, and with unknown values. Whole drives are compared with the
``Monitor``, and with the tables.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from random import Random
from typing import Any

import numpy as np

from rulec.automata.mealy_monitor import IMPOSSIBLE
from rulec.code_generation.code_messages import differs
from rulec.code_generation.compiled_c.c_library import CAnswer, CLibrary, CMonitor
from rulec.code_generation.monitor_layout import (
    MOST_VARIABLES,
    VERDICTS,
    MonitorLayout,
    RuleLayout,
)
from rulec.code_generation.proof.probing_inputs import ReadingProbe, nests, probes, weighs
from rulec.code_generation.proof.random_drives import Drive, TableDrive, drives, table_drives
from rulec.diagnostics import RulecError
from rulec.monitoring.monitoring_messages import VIOLATED_AXIOM
from rulec.monitoring.online.four_valued import RunningVerdict, best_of, four_valued, worst_of
from rulec.monitoring.online.monitor_state import SoFar
from rulec.monitoring.online.running_monitor import RunningMonitor
from rulec.rulebook.rules.axiom_instances import counts
from rulec.trace import State

EXCLUDED_CLASS = 0x7FFF

USUAL_STATES = 2000
"""The number of states of drives of each kind that a proof compares."""

_MOST_DIGITS = 1 << 12


@dataclass(frozen=True, slots=True)
class ProofPart:
    """What was compared, how often, and the first few differences."""

    subject: str
    n: int
    differs: tuple[str, ...]


def proof_report(layout: MonitorLayout, n_states: int = USUAL_STATES) -> str:
    """The report on what was compared for a monitor, and how often, line by line.

    Raises RulecError R0751 and R0752 if it cannot be compiled, R0753 if something differs.
    """
    library = CLibrary(layout)
    parts = list(proof_of(library, n_states))
    if wrong := [text for part in parts for text in part.differs]:
        raise differs(wrong)
    book = layout.rulebook
    lines = [
        f"monitor in C of {book.name}, by rulec {book.rulec}",
        *[f"source: {source.name}, SHA-256 {source.sha256}" for source in book.sources],
        f"compiled by: {library.command}, {library.compiler_version}",
        *[f"{part.n:>9} {part.subject}: 0 differ" for part in parts],
    ]
    return "\n".join([*lines, ""])


def proof_of(library: CLibrary, n_states: int) -> Iterator[ProofPart]:
    """All parts of the proof of a monitor; drives of each kind have ``n_states`` states in all."""
    yield _part("numbers stand in the compiled tables as they were laid out", _tables(library))
    yield _part("letters have the class that they have in the table", _letters(library))
    yield _part("steps lead from each state by each class where the table says", _steps(library))
    yield _part("values below, at and above limits, and unknown ones, are read", _readings(library))
    yield _part(
        "states of which all is known have the verdicts of the monitor in Python, or perhaps no "
        "narrower ones where a sum is near its limit",
        _runs(library, n_states, share_unknown=0.0),
    )
    yield _part(
        "states of which not all is known, or with objects without a seat, have no narrower "
        "verdicts than those of the monitor in Python",
        _runs(library, n_states, share_unknown=0.1),
    )
    yield _part(
        "states made for letters of the tables have the tables' verdicts and Python's",
        _words(library, n_states),
    )


def _part(subject: str, differences: Iterator[str]) -> ProofPart:
    """The result of one part; each difference is a text that is empty if there is none."""
    n = 0
    different: list[str] = []
    for text in differences:
        n += 1
        if text and len(different) < 5:
            different.append(text)
    return ProofPart(subject, n, tuple(different))


def _tables(library: CLibrary) -> Iterator[str]:
    ask = library.call("numbers")
    for number, own in enumerate(library.layout.rules):
        cells, entries = ((ctypes.c_uint16 * len(column))() for column in (own.cells, own.entries))
        ask(number, cells, entries)
        for kind, read_back, laid in (("cell", cells, own.cells), ("entry", entries, own.entries)):
            yield from _each(np.array(read_back) == np.array(laid), f"rule {own.rule.name}, {kind}")


def _letters(library: CLibrary) -> Iterator[str]:
    ask: Callable[..., None] = library.call("all_classes")
    for number, own in enumerate(library.layout.rules):
        reads, sizes = _numbers(own)
        n = prod(sizes)
        classes = (ctypes.c_uint16 * n)()
        ask(number, reads, (ctypes.c_uint32 * max(1, len(sizes)))(*sizes), len(sizes), classes)
        expected = np.array(own.rule.machine.letters)
        expected[expected == IMPOSSIBLE] = EXCLUDED_CLASS
        equal = np.array(classes) == expected
        yield from _each(equal, f"rule {own.rule.name}, letter")


def _steps(library: CLibrary) -> Iterator[str]:
    ask = library.call("all_steps")
    for number, own in enumerate(library.layout.rules):
        machine = own.rule.machine
        n = len(machine.successors) * len(machine.successors[0])
        reached, by_sets = (ctypes.c_uint16 * n)(), (ctypes.c_uint16 * n)()
        verdicts = (ctypes.c_uint8 * n)()
        if own.n_instances == 0:
            continue
        ask(number, reached, verdicts, by_sets)
        states = np.array(machine.successors).ravel()
        expected_verdicts = [
            VERDICTS.index(four_valued(machine, target, accepted))
            for targets, row in zip(machine.successors, machine.outputs, strict=True)
            for target, accepted in zip(targets, row, strict=True)
        ]
        expected = states * 4 + np.array(expected_verdicts)
        equal = (np.array(reached) * 4 + np.array(verdicts) == expected) & (
            np.array(by_sets) == expected
        )
        yield from _each(equal, f"rule {own.rule.name}, pair of state and class")


def _each(equal: Any, subject: str) -> Iterator[str]:
    for place, is_equal in enumerate(equal.tolist()):
        yield "" if is_equal else f"{subject} {place}"


def _numbers(own: RuleLayout) -> tuple[Any, list[int]]:
    """The places of a rule's reads as encoded in the cells, and their sizes."""
    reads = [source << 12 | place for source, place in own.reads]
    sizes = [read.size for read in own.rule.machine.reads]
    return (ctypes.c_uint32 * max(1, len(reads)))(*reads), sizes


def _readings(library: CLibrary) -> Iterator[str]:
    digits = (ctypes.c_uint16 * _MOST_DIGITS)()
    ask = library.call("digits")
    for probe in probes(library.layout):
        source, place = probe.place
        given, places = _input(library, probe)
        ask(ctypes.byref(given), places, source, digits)
        low, more = digits[place] & 0xFF, digits[place] >> 8
        read = ((1 << (more + 1)) - 1) << low
        right = read == probe.digits if probe.is_sharp else read & probe.digits == probe.digits
        yield "" if right else f"rule {probe.rule}, read {probe.number}, of {probe.state}"


def _input(library: CLibrary, probe: ReadingProbe) -> tuple[ctypes.Structure, Any]:
    given = library.input_of(probe.state, probe.objects, {})
    names = list(probe.objects)
    places = [names.index(item) for item in probe.binding]
    return given, (ctypes.c_size_t * MOST_VARIABLES)(*places)


def _runs(library: CLibrary, n_states: int, share_unknown: float) -> Iterator[str]:
    both = BothMonitors(library, is_known=share_unknown == 0)
    for drive in drives(library.layout, Random(n_states), n_states, share_unknown):
        yield from both.judge(drive)


def _words(library: CLibrary, n_states: int) -> Iterator[str]:
    both = BothMonitors(library, is_known=True)
    for word in table_drives(library.layout, Random(n_states), n_states):
        yield from both.judge_word(word)


EXCLUDED_BY_FACTS = 5

MOST_PREPARED = 4096


class BothMonitors:
    """A compiled monitor and Python's. If all values are known (``is_known``), they must agree.

    If sums of several numbers decide, or values are unknown, the compiled verdicts may be wider.
    """

    def __init__(self, library: CLibrary, *, is_known: bool) -> None:
        self._library = library
        self._book = library.layout.rulebook
        self._known = is_known
        rules = [own.rule for own in library.layout.rules]
        self._weighing = {rule.name for rule in rules if any(map(weighs, rule.machine.reads))}
        self._vague = {
            rule.name for rule in rules if not is_known and any(map(nests, rule.machine.reads))
        }
        # C does not check facts with counts.
        self._counting = any(counts(axiom.formula) for axiom in self._book.axioms)
        self._ids: dict[str, int] = {}
        self._inputs: dict[int, tuple[State, Any]] = {}
        self._codes: dict[RunningVerdict, bytes] = {}

    def judge(self, drive: Drive) -> Iterator[str]:
        """For each state a text: empty, or how the monitors differ."""
        return (text for text, _ in self._steps(drive))

    def judge_word(self, word: TableDrive) -> Iterator[str]:
        """As ``judge``, and that no verdict on the word's rule is better than the table's."""
        name = word.rule.name
        follows = True
        for number, (text, answer) in enumerate(self._steps(word.drive)):
            # A state excluded by facts together with other objects' defaults was not taken.
            follows = follows and answer is not None
            expected = VERDICTS.index(word.verdicts[number])
            if (
                follows
                and answer is not None
                and VERDICTS.index(worst_of(answer.rules[name])) < expected
            ):
                yield f"rule {name}, better than {VERDICTS[expected]}, state {number}"
            else:
                yield text

    def _steps(self, drive: Drive) -> Iterator[tuple[str, SoFar | None]]:
        ours, theirs = RunningMonitor(self._book), CMonitor(self._library)
        # Equal verdicts share one mapping while the same states recur.
        packed: dict[int, tuple[Mapping[str, RunningVerdict], bytes]] = {}
        for number, (state, objects) in enumerate(drive):
            status = theirs.take(self._input(state, objects))
            try:
                our = ours.step(state, objects)
            except RulecError as error:
                by_facts = error.diagnostics[0].code == VIOLATED_AXIOM.code
                if status != EXCLUDED_BY_FACTS:
                    # Several facts together may exclude unknown values; C checks each fact
                    # separately.
                    missed = by_facts and self._known and not self._counting
                    yield (f"not excluded by facts: {state}" if missed else ""), None
                    return
                yield "", None
                continue
            if status != 0:
                yield f"status {status}, state {number}: {state}", our
                return
            mapping, expected = packed.get(id(our.rules), (None, b""))
            if mapping is not our.rules:
                verdicts = our.verdict, *our.rules.values()
                expected = b"".join([self._code(verdict) for verdict in verdicts])
                packed[id(our.rules)] = our.rules, expected
            n_lost = len(ours.violations) if self._known and not self._weighing else None
            if theirs.says(expected, n_lost):
                yield "", our
            else:
                yield self._compared(our, theirs.last_answer(status), n_lost, str(state)), our

    def _input(self, state: State, objects: Mapping[str, str]) -> Any:
        """The state as C input, prepared once while it recurs."""
        kept = self._inputs.get(id(state))
        if kept is None or kept[0] is not state:
            if len(self._inputs) >= MOST_PREPARED:
                self._inputs.clear()
            kept = state, self._library.input_of(state, objects, self._ids)
            self._inputs[id(state)] = kept
        return kept[1]

    def _code(self, verdict: RunningVerdict) -> bytes:
        if verdict not in self._codes:
            both = best_of(verdict), worst_of(verdict)
            self._codes[verdict] = bytes(VERDICTS.index(outcome) for outcome in both)
        return self._codes[verdict]

    def _compared(self, ours: SoFar, theirs: CAnswer, n_lost: int | None, where: str) -> str:
        if n_lost is not None and theirs.violations != n_lost:
            return f"the number of violations, {where}"
        for name in [name for name in ours.rules if name not in self._vague]:
            expected = ours.rules[name]
            other = theirs.rules[name]
            right = is_no_narrower(other, expected)
            if self._known and name not in self._weighing:
                right = other == expected
            if not right:
                return f"rule {name}, {expected} and {other}, {where}"
        right = bool(self._vague) or is_no_narrower(theirs.verdict, ours.verdict)
        return "" if right else f"the rulebook, {where}"


def is_no_narrower(wide: RunningVerdict, narrow: RunningVerdict) -> bool:
    """Whether a verdict range lies within another one, or equals it."""
    ranks: Sequence[int] = [
        VERDICTS.index(verdict)
        for verdict in (best_of(wide), best_of(narrow), worst_of(narrow), worst_of(wide))
    ]
    return list(ranks) == sorted(ranks)
