"""Checks of recordings built by programs, with all mistakes reported at once."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy import float64
from numpy.typing import ArrayLike, NDArray

from rulec.diagnostics import Diagnostic, RulecError, did_you_mean, named
from rulec.recordings.encodings.file_values import LARGEST
from rulec.recordings.lanes.lanes_along import CLOSEST_M
from rulec.recordings.polylines import line_length, without_repeats
from rulec.recordings.recording import LIGHT_COLOURS, LONGEST_M, Light, ObservedLight, Points
from rulec.recordings.recording_messages import NOT_BUILT
from rulec.value_display import brief

_MOST_SHOWN = 20


class BuildingChecks:
    """The mistakes in something that is built, which are reported together."""

    def __init__(self, about: str) -> None:
        self.about = about
        self.problems: list[Diagnostic] = []

    def wrong(self, why: str, expected: str = "", help_text: str = "") -> None:
        """Record a mistake."""
        message = f"{self.about}: {why}"
        self.problems.append(NOT_BUILT.at(None, message, expected=expected, help=help_text))

    def raise_problems(self) -> None:
        """Raise RulecError R0617 if there is any mistake."""
        if self.problems:
            raise RulecError(self.problems[:_MOST_SHOWN])

    def numbers(self, name: str, values: ArrayLike, count: int | None = None) -> NDArray[float64]:
        """A row of finite numbers, as many as required; zeros after a mistake."""
        try:
            numbers = np.array(values, dtype=float)
        except (TypeError, ValueError, OverflowError):
            numbers = np.full(0, np.nan)
            self.wrong(f"`{name}` holds something that is no number", "expected a row of numbers")
            return np.zeros(count or 1)
        if numbers.ndim == 0 and count is not None:
            numbers = np.full(count, numbers)
        if numbers.ndim != 1 or (count is not None and len(numbers) != count):
            size = "one number" if numbers.ndim == 0 else f"an array of shape {numbers.shape}"
            many = "" if count is None else f"{count:,} "
            self.wrong(f"`{name}` is {size}", f"expected a row of {many}numbers")
            return np.zeros(count or 1)
        self._bounded(name, numbers)
        return numbers

    def points(self, name: str, values: ArrayLike) -> Points:
        """Two points or more; a line of two points after a mistake."""
        line = np.array([[0.0, 0.0], [1.0, 0.0]])
        try:
            points = np.array(values, dtype=float)
        except (TypeError, ValueError, OverflowError):
            self.wrong(f"`{name}` holds something that is no number", "expected points (x, y)")
            return line
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2:
            shape = f"an array of shape {points.shape}"
            self.wrong(f"`{name}` is {shape}", "expected two points (x, y) or more in order")
            return line
        if not self._bounded(name, points):
            return line
        kept = without_repeats(points, CLOSEST_M)
        if len(kept) < 2:
            self.wrong(f"`{name}` has one place only", "expected two different points or more")
            return line
        length = line_length(kept)
        if length > LONGEST_M:
            self.wrong(f"`{name}` is {length:,.0f} m long", f"expected {LONGEST_M:,.0f} m at most")
        return kept

    def light(self, light: Light | ObservedLight) -> None:
        """Record a light with colours that do not exist, or that shows none at some time."""
        colours: list[object] = []
        if isinstance(light, ObservedLight):
            by_step: object = light.colours
            if not isinstance(by_step, Mapping):
                self.wrong("`lights` has an `ObservedLight` without colours by time step")
                return
            for step in by_step:
                if not isinstance(step, int | np.integer):
                    self.wrong(f"`lights` has the time step {step!r:.40}", "expected whole numbers")
                    return
            colours += by_step.values()
        elif not isinstance(light.begin, int | np.integer) or not _are_phases(light.phases):
            self.wrong(
                "`lights` has a `Light` that is no programme",
                "expected a time step, and pairs of a colour and 1 or more time steps, such as "
                'Light(0, (("red", 20), ("green", 30)))',
            )
            return
        else:
            colours += [colour for colour, _ in light.phases]
        for colour in dict.fromkeys(map(str, colours)):
            self.one_of("lights", colour, LIGHT_COLOURS)

    def _bounded(self, name: str, numbers: NDArray[float64]) -> bool:
        bad = ~(np.abs(numbers) < LARGEST)
        if bad.any():
            at = tuple(int(axis[0]) for axis in np.nonzero(bad))
            place = ", ".join(map(str, at))
            why = f"`{name}[{place}]` is {numbers[at]:g}"
            self.wrong(why, f"expected a number below {LARGEST:.0e}")
        return not bad.any()

    def positive(self, name: str, value: float, unit: str, below: float = LARGEST) -> float:
        """A number above 0; 1 after a mistake."""
        if not isinstance(value, int | float | np.number) or not 0 < value < below:
            most = f" and below {below:g}" if below < LARGEST else ""
            expected = f"expected a number above 0{most}, in {unit}"
            self.wrong(f"`{name}` is {brief(value):.40}", expected)
            return 1.0
        return float(value)

    def one_of(self, name: str, value: str, known: Collection[str]) -> None:
        """Record an unknown word."""
        if not isinstance(value, str) or value not in known:
            shown = value if isinstance(value, str) else brief(value)
            some = named(sorted(known))
            self.wrong(f"`{name}` is `{shown:.40}`", f"expected {some}", did_you_mean(shown, known))


def _are_phases(phases: object) -> bool:
    return (
        isinstance(phases, tuple | list)
        and bool(phases)
        and all(
            isinstance(phase, tuple | list)
            and len(phase) == 2
            and isinstance(phase[0], str)
            and isinstance(phase[1], int | np.integer)
            and phase[1] >= 1
            for phase in phases
        )
    )
