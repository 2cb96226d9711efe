"""Drives judged by a compiled monitor and by Python's, whose verdicts must agree."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rulec.code_generation.compiled_c.c_library import CAnswer, CLibrary, CMonitor
from rulec.code_generation.monitor_layout import VERDICTS
from rulec.code_generation.proof.probing_inputs import nests, weighs
from rulec.code_generation.proof.random_drives import Drive, TableDrive
from rulec.diagnostics import RulecError
from rulec.monitoring.monitoring_messages import VIOLATED_AXIOM
from rulec.monitoring.online.four_valued import RunningVerdict, best_of, worst_of
from rulec.monitoring.online.monitor_state import SoFar
from rulec.monitoring.online.running_monitor import RunningMonitor
from rulec.rulebook.rules.axiom_instances import counts
from rulec.trace import State

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
