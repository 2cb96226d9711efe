"""Drives of candidates among participants of unknown type, by the types that these may have."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from rulec.extraction.candidate_drives import Block, CandidateDrives
from rulec.extraction.possible_types import PossibleTypes
from rulec.extraction.selection import with_drives_otherwise
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.extraction.traces.to_trace import TraceWriter
from rulec.recordings.recording import Participant


@dataclass(frozen=True)
class DrivesByType:
    """The drives of candidates among others, each with those of ``otherwise``.

    As in a recording, these are for candidates that have a participant of unknown type near them.
    """

    drives: CandidateDrives

    @cached_property
    def _types(self) -> PossibleTypes:
        return PossibleTypes(self.drives.recording)

    @cached_property
    def _otherwise(self) -> Sequence[CandidateDrives]:
        """The drives among the same others, if those of unknown type had one that they may have."""
        own = self.drives
        return [
            CandidateDrives(recording, own.side, own.thresholds, own.span)
            for recording in self._types.recordings()
        ]

    def in_blocks(self, candidates: Sequence[Participant], writer: TraceWriter) -> Iterator[Block]:
        """The drives of candidates, block by block; the first contains the first candidate."""
        for block in self.drives.in_blocks(candidates, writer):
            if writer.defaults:
                yield block
                continue
            reach_m = 2 * self.drives.thresholds.near_m
            near = [x for x, _ in block if self._types.is_near(candidates[x], reach_m)]
            yield self._with_others(block, near, candidates, writer) if near else block

    def _with_others(
        self,
        block: Block,
        near: Sequence[int],
        candidates: Sequence[Participant],
        writer: TraceWriter,
    ) -> Block:
        bodies = [candidates[number] for number in near]
        writer = replace(writer, bare=True)
        found = [
            dict(zip(near, drives.of(bodies, writer), strict=True)) for drives in self._otherwise
        ]

        def of(number: int, own: tuple[Drive | NoDrive, ...]) -> tuple[Drive | NoDrive, ...]:
            others = [of_type[number] for of_type in found if number in of_type]
            return tuple(with_drives_otherwise(own, others))

        return [(number, of(number, own)) for number, own in block]
