"""Limits on the spread of a file's time steps, to bound memory."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.recording import MOST_STEPS, SPARSEST

SPARSEST_STATES = 200
"""At least one in this many pairs of an obstacle and a time step must have a state in the file."""

_NEVER_TOO_MANY = 2_000_000
_WAY_OUT = "look for a time that is wrong, or take a part"


@dataclass(slots=True)
class TimeExtent:
    """The time steps of the obstacles in a file, collected while it is read.

    ``repeated``: the number of steps in intervals of time, not counting the first one of each.
    """

    moments: set[int] = field(default_factory=set)
    states: int = 0
    repeated: int = 0

    def add(self, steps: Iterable[int]) -> None:
        """Note the time steps of states."""
        known = tuple(steps)
        self.moments.update(known)
        self.states += len(known)

    def check(self, path: Path, form: FileFormat, obstacles: int) -> None:
        """Raise RulecError R0610 if the time steps are too far apart for the number of states."""
        first, last = min(self.moments, default=0), max(self.moments, default=0)
        spread = last - first
        most = max(_NEVER_TOO_MANY, SPARSEST_STATES * self.states)
        too_far = spread > min(MOST_STEPS, SPARSEST * len(self.moments))
        if too_far or (spread + 1) * obstacles > most:
            why = (
                f"the time steps {first} to {last} are too far apart for its content "
                f"(obstacles: {obstacles:,}, states: {self.states:,})"
            )
            raise form.refused(path, why, help_text=_WAY_OUT)


def read_steps(tree: Tree, extent: TimeExtent) -> range:
    """The time steps in an element: an exact one, or an interval.

    Raises RulecError R0610 for intervals that are longer than any recording.
    """
    if (exact := tree.first("exact")) is not None:
        first = last = exact.whole()
    else:
        first, last = (tree.child(name).whole() for name in ("intervalStart", "intervalEnd"))
    if last < first:
        raise tree.wrong(f"an interval of time begins at step {first} and ends at {last}")
    extent.add((first, last))
    extent.repeated += last - first
    if extent.repeated > MOST_STEPS:
        why = f"its intervals of time have more than {MOST_STEPS:,} steps in total"
        raise tree.form.refused(tree.path, why, tree.place, help_text=_WAY_OUT)
    return range(first, last + 1)
