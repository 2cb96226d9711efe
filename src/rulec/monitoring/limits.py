"""Limits of monitoring that a user can meet."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MonitoringLimits:
    """Limits, each with its unit and its effect.

    Attributes:
        states_shown: states; an explanation shows a longer stretch by its first state and those up
            to the one behind the decisive one.
        repairs_listed: sets of values; of what a state might have had instead, no more are listed.
        states_explained: states; of a longer trace an explanation looks at no more than so many on
            either side of the decisive one.
        states_together: states; ``verify_many`` reads traces with so many before it answers.
    """

    states_shown: int = 10
    repairs_listed: int = 8
    states_explained: int = 10_000
    states_together: int = 1 << 18


LIMITS = MonitoringLimits()
