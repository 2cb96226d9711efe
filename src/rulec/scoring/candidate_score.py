"""What one candidate comes to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rulec.extraction.drives import NoDrive
from rulec.extraction.recording_verdicts import DriveVerdict
from rulec.monitoring.verdict import OpenVerdict, RuleNotJudged, Violation
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class CandidateScore:
    """What one candidate comes to, by its ``number``, after what was before.

    ``violations`` and ``open`` verdicts are those that it is charged with; the step of a violation
    is a state of the candidate, from 0, before 0 one of the past, None if its end decides.
    ``not_judged`` are rules that the world tells too little for. ``off_road`` of its states are in
    no drive, because ego is on no lane there that leads its way, so that no rule is judged in
    these, or with ego's middle beside all lanes, or driven backwards; ``why`` says more. ``drives``
    are what ``verify_recording`` gives of past and candidate; of many candidates they are made when
    they are asked for. ``late`` states pass before what the past has violated is kept for good.
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

    @property
    def satisfied(self) -> bool | None:
        """Whether no hard rule is violated; None if one is open, or not judged all the way."""
        if any(violation.strength == "hard" for violation in self.violations):
            return False
        is_open = any(result.strength == "hard" for result in self.open)
        return None if is_open or self.off_road else True
