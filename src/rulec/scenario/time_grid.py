"""Horizon and step: the number of layers, and when they begin."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from rulec.diagnostics.argument_kinds import is_finite
from rulec.scenario.scenario_messages import UNFITTING_HORIZON

MAX_LAYERS = 10_000
# A step typed as 0.3333333333 means a third; one typed as 0.3333 does not
_ROUNDING = Fraction(1, 10**9)


@dataclass(frozen=True, slots=True)
class Timing:
    """``layers`` layers, exactly ``step`` seconds apart."""

    step: Fraction
    layers: int

    def start(self, layer: int) -> float:
        """The time (s) at which a layer begins."""
        return float(self.step * layer)


def timing(horizon_s: float, step_s: float) -> Timing:
    """The ``horizon / step + 1`` layers of a horizon (s) divided into steps (s).

    Decimals are taken exactly as typed, so that 4.0 s is forty steps of 0.1 s. Raises RulecError
    R0606 if a value is not a time above 0, the horizon is not a whole multiple of the step, or
    there would be more than ``MAX_LAYERS`` layers.
    """
    for name, value in (("horizon", horizon_s), ("step", step_s)):
        number = not isinstance(value, bool) and isinstance(value, (int, float))
        if not number or not is_finite(value) or value <= 0:
            raise UNFITTING_HORIZON.error(
                None,
                f"the {name} is `{value}`",
                expected="expected a time in seconds, above 0",
                help=f"give the {name} as a number of seconds, such as 0.5",
            )
    horizon, step = Fraction(str(horizon_s)), Fraction(str(step_s))
    steps = round(horizon / step)
    if steps >= MAX_LAYERS:
        raise UNFITTING_HORIZON.error(
            None,
            f"a horizon of {horizon_s:g} s in steps of {step_s:g} s has too many layers",
            expected=f"expected fewer than {MAX_LAYERS} steps",
            help="take a longer step or a shorter horizon",
        )
    if steps == 0 or abs(horizon - steps * step) > _ROUNDING * horizon:
        steps = max(steps, 1)
        raise UNFITTING_HORIZON.error(
            None,
            f"the horizon of {horizon_s:g} s is not a whole number of steps of {step_s:g} s",
            expected="expected a horizon that is a multiple of the step",
            help=f"{_steps_that_fit(horizon, steps)}, or a horizon of {float(step * steps)!r} s",
        )
    return Timing(horizon / steps, steps + 1)


def whole_steps(horizon_s: float, step_s: float) -> float:
    """The longest whole number of steps (s) within a horizon, but at least one step."""
    step = Fraction(str(step_s))
    return float(max(Fraction(str(horizon_s)) // step, 1) * step)


def _steps_that_fit(horizon: Fraction, steps: int) -> str:
    """A hint with the steps that divide the horizon and are nearest to a number of steps."""
    numbers = [
        number
        for number in range(1, min(4 * steps + 4, MAX_LAYERS))
        if (horizon / number * _SHORT).denominator == 1
    ]
    longer = [number for number in numbers if number <= steps][-1:]
    shorter = [number for number in numbers if number > steps][:1]
    fitting = [f"{float(horizon / number):g} s" for number in (*shorter, *longer)]
    return f"a step of {' or '.join(fitting)} would fit" if fitting else "take another step"


_SHORT = 1000
"""A suggested step has at most three decimals."""
