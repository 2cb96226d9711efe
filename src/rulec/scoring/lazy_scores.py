"""Candidates' scores without their drives, which take much memory and are recomputed on demand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TypeAlias, overload

from rulec.extraction.recording_verdicts import DriveVerdict
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.monitoring.verdict import OpenReasons, OpenVerdict
from rulec.scoring.candidate_score import CandidateScore

_OneDrive: TypeAlias = DriveVerdict | NoDrive


class _Again:
    """The score of one candidate, recomputed on first access."""

    def __init__(self, scored: Callable[[], CandidateScore]) -> None:
        self._scored = scored

    @cached_property
    def found(self) -> CandidateScore:
        return self._scored()

    def reasons(self, place: int) -> OpenReasons:
        """The reasons of the open verdict at an index, those of the past counted last."""
        own = (*self.found.open, *self.found.open_before)[place]
        return OpenReasons(own.because, own.depends_on, own.outcomes, own.exact)


@dataclass(frozen=True, slots=True, eq=False)
class _LaterDrives(Sequence[_OneDrive]):
    """A candidate's drives, ``n_drives`` in number, recomputed on access."""

    again: _Again
    n_drives: int

    def __len__(self) -> int:
        return self.n_drives

    @overload
    def __getitem__(self, place: int) -> _OneDrive: ...

    @overload
    def __getitem__(self, place: slice) -> Sequence[_OneDrive]: ...

    def __getitem__(self, place: int | slice) -> _OneDrive | Sequence[_OneDrive]:
        return self.again.found.drives[place]

    def __eq__(self, other: object) -> bool:
        """Whether the drives are equal."""
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type[tuple[_OneDrive, ...]], tuple[Sequence[_OneDrive]]]:
        return tuple, (self.again.found.drives,)


def without_drives(
    found: CandidateScore, n_drives: int, scored: Callable[[], CandidateScore]
) -> CandidateScore:
    """A candidate's score without its drives and reasons, which ``scored`` recomputes."""
    again = _Again(scored)
    doubtful = [
        OpenVerdict.explained_later(
            open_verdict.rule,
            open_verdict.strength,
            open_verdict.binding,
            partial(again.reasons, place),
        )
        for place, open_verdict in enumerate((*found.open, *found.open_before))
    ]
    drives, n_own = _LaterDrives(again, n_drives), len(found.open)
    return replace(
        found, open=tuple(doubtful[:n_own]), open_before=tuple(doubtful[n_own:]), drives=drives
    )
