"""The score of one candidate, also without its drives, which are recomputed on demand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TypeAlias, overload

from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import fault_of
from rulec.extraction.recording_verdicts import DriveVerdict
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.monitoring.verdict import (
    OpenReasons,
    OpenVerdict,
    RuleFor,
    RuleNotJudged,
    Violation,
    rule_for,
)
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class CandidateScore:
    """The score of candidate ``number``, after its past.

    ``violations`` and ``open`` verdicts are those charged to it; the step of a violation is a state
    of the candidate, from 0, negative for a state of the past, None if the end decides.
    ``not_judged`` are rules for which the world provides too little. ``off_road`` is the number of
    its states that are in no judged drive, mostly because ego is on no lane there in its direction,
    or with ego's middle beside all lanes, or driven backwards; ``why`` gives the reason. ``drives``
    are those of ``verify_recording`` for past and candidate; if there are many candidates they are
    computed on demand. ``late`` is the number of states until everything that the past violated is
    kept for good. ``is_judged``: whether any of its states is in a judged drive. ``judged_from``
    has, for a violation of what the past had violated, too, the state of the candidate from which
    it is judged anew. ``open_before`` are the open verdicts that the past alone leaves open, and
    the candidate's own states keep; they are charged to no candidate. ``faults`` are those of rulec
    that came meanwhile; rules that they cost are ``not_judged``.
    """

    __repr__ = short_repr

    number: int
    violations: tuple[Violation, ...]
    open: tuple[OpenVerdict, ...]
    not_judged: tuple[RuleNotJudged, ...]
    off_road: int
    why: str
    drives: Sequence[DriveVerdict | NoDrive]
    late: int = 0
    is_judged: bool = True
    judged_from: Mapping[RuleFor, int] = field(default_factory=dict)
    open_before: tuple[OpenVerdict, ...] = ()
    faults: tuple[RulecError, ...] = field(default=(), compare=False)

    def apart(self, about: Set[RuleFor]) -> CandidateScore:
        """The score in which what is open of these counts as open before."""
        if not about:
            return self
        own, before = (
            tuple([result for result in self.open if (rule_for(result) in about) is is_before])
            for is_before in (False, True)
        )
        return replace(self, open=own, open_before=before)

    @property
    def satisfied(self) -> bool | None:
        """Whether no hard rule is violated; None if one is open or not judged, or ego off the road.

        As in the verdict of ``verify_recording``, unless the past has violated something or left it
        open.
        """
        if self.satisfied_as_judged and any(rule.strength == "hard" for rule in self.not_judged):
            return None
        return self.satisfied_as_judged

    @property
    def satisfied_as_judged(self) -> bool | None:
        """``satisfied`` by the rules that can be judged in this world, whatever the others say."""
        if any(violation.strength == "hard" for violation in self.violations):
            return False
        doubtful: tuple[OpenVerdict | RuleNotJudged, ...] = (*self.open, *self.lost)
        is_open = any(result.strength == "hard" for result in doubtful)
        return None if is_open or self.off_road else True

    @property
    def lost(self) -> tuple[RuleNotJudged, ...]:
        """The rules that a fault of rulec has cost; they are charged as if they were open."""
        return tuple([rule for rule in self.not_judged if rule.by_fault])


def lost_candidate(number: int, n_states: int, problem: Exception) -> CandidateScore:
    """A candidate that an exception has cost: no state is judged. Raises what is no fault."""
    fault = fault_of(problem, f"candidate {number}")
    why = fault.diagnostics[0].message
    return CandidateScore(
        number,
        violations=(),
        open=(),
        not_judged=(),
        off_road=n_states,
        why=why,
        drives=(NoDrive("", why, fault),),
        is_judged=False,
        faults=(fault,),
    )


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
