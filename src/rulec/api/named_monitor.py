"""A monitor of rules in any form, such as the name of a rulebook."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import TYPE_CHECKING

from rulec.api.rulebook_compilation import machines
from rulec.monitoring.online import running_monitor

if TYPE_CHECKING:
    from rulec.api.rulebook_compilation import Rules


class Monitor(running_monitor.RunningMonitor):
    """A monitor of a trace whose states arrive one after the other.

    A step takes as long after a million states as after one: the past is represented by the states
    of the rules' machines, one for each binding of a rule to objects that are present.

    Args:
        rulebook: the name or path of a rulebook, or one that has been read or compiled.
        step_s: seconds from one state to the next; needed only by rules with bounds in seconds. If
            omitted, the step that they were compiled for.
        told: the names that the source can provide; other names are unknown in states that do not
            contain them, except those with ``presumed`` defaults. If omitted, all have defaults.
        cut: the time before the first state, and before an object appeared, is unknown; an object
            that has left was lost from view, so what is pending about it stays open.

    Raises RulecError for rules that cannot be compiled, R0507 if a rule was compiled for another
    step and cannot be compiled again, R0403 if it is cut and Spot is not installed.
    """

    def __init__(
        self,
        rulebook: Rules,
        step_s: Fraction | float | None = None,
        *,
        told: Iterable[str] | None = None,
        cut: bool = False,
    ) -> None:
        super().__init__(machines(rulebook), step_s, told=told, cut=cut)
