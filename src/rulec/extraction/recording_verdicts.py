"""Recorded drives, judged: each vehicle as ego in turn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.extraction.drives import NoDrive
from rulec.extraction.selection.requested import RequestedDrives, selected_drives
from rulec.extraction.to_trace import Drive
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.batch_verify import verify_chunk
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.scenario.recorded.recording import Recording

MOST_STATES = 1 << 13
"""Drives with so many states together are judged together."""


@dataclass(frozen=True, slots=True)
class DriveVerdict:
    """A drive and what the rulebook says of it."""

    drive: Drive
    answer: Verdict | NotJudged


class RecordingVerdicts:
    """A recording's drives before a rulebook; they are worked out when they are asked for.

    Raises:
        RulecError: R0407 if the rulebook has bounds that are no multiples of the recording's step,
            R0507 if it was compiled for another step, R0612 for a vehicle that is not there.
    """

    def __init__(
        self,
        recording: Recording,
        rulebook: CompiledRulebook,
        wanted: RequestedDrives,
        file: str,
    ) -> None:
        rules = rulebook.fitted_to(recording.step_s)
        self.rules = rules
        self.drives = selected_drives(
            recording, wanted, file, rules.traffic, rules.vocabulary, _read_by(rules)
        )
        self.recording = self.drives.recording
        self.mirrored = self.drives.mirrored
        self.egos = self.drives.egos

    def answers(self) -> Iterator[DriveVerdict | NoDrive]:
        """What each vehicle did, in the order of the file."""
        waiting: list[Drive | NoDrive] = []
        states = 0
        for one in (one for ego in self.egos for one in self.drives.of(ego)):
            waiting.append(one)
            states += len(one.trace.states) if isinstance(one, Drive) else 0
            if states >= MOST_STATES:
                yield from self._judged(waiting)
                waiting, states = [], 0
        yield from self._judged(waiting)

    def _judged(self, drives: list[Drive | NoDrive]) -> Iterator[DriveVerdict | NoDrive]:
        traces = [one.trace for one in drives if isinstance(one, Drive)]
        answers = iter(verify_chunk(traces, self.rules))
        for one in drives:
            yield DriveVerdict(one, next(answers)) if isinstance(one, Drive) else one

    def by_default(self, words: frozenset[str]) -> dict[str, tuple[str, ...]]:
        """For every rule what it reads beyond these words, so that it has its default all along.

        In the order of the vocabulary.
        """
        declared = self.rules.vocabulary.declarations
        found = {}
        for rule in self.rules.rules:
            read = set(names_in(rule.formula))
            found[rule.name] = tuple(x for x in declared if x in read and x not in words)
        return found


def _read_by(rules: CompiledRulebook) -> frozenset[str]:
    formulas = [one.formula for one in rules.rules] + [one.formula for one in rules.axioms]
    return frozenset(name for formula in formulas for name in names_in(formula))
