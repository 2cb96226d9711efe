"""Horizon and step."""

from fractions import Fraction

import pytest

from rulec.diagnostics import RulecError
from rulec.scenario.time_grid import timing


@pytest.mark.parametrize(
    ("horizon", "step", "layers", "exact"),
    [
        (4.0, 1.0, 5, Fraction(1)),
        (4, 1, 5, Fraction(1)),
        (4.0, 0.5, 9, Fraction(1, 2)),
        (4.0, 0.1, 41, Fraction(1, 10)),  # 4.0 // 0.1 is 39 in floating point
        (0.3, 0.1, 4, Fraction(1, 10)),  # 0.1 * 3 is more than 0.3
        (1.1, 0.1, 12, Fraction(1, 10)),
        (1.0, 1 / 3, 4, Fraction(1, 3)),
        (2.5, 2.5, 2, Fraction(5, 2)),
    ],
)
def test_layers(horizon, step, layers, exact):
    times = timing(horizon, step)
    assert (times.layers, times.step) == (layers, exact)
    assert times.start(layers - 1) == horizon


@pytest.mark.parametrize(
    ("horizon", "step", "words"),
    [
        (4.0, 0.3, "not a whole number of steps of 0.3 s"),
        (4.0, 0.3333, "not a whole number of steps"),
        (4.0, 8.0, "not a whole number of steps of 8 s"),
        (1.0, 1e-9, "too many layers"),
        (1e300, 1e-300, "too many layers"),
        (float("nan"), 1.0, "the horizon is `nan`"),
        (4.0, float("inf"), "the step is `inf`"),
        (4.0, 0.0, "the step is `0.0`"),
        (-4.0, 1.0, "the horizon is `-4.0`"),
        (4.0, True, "the step is `True`"),
        (4.0, "1", "the step is `1`"),
        (None, 1.0, "the horizon is `None`"),
    ],
)
def test_what_does_not_fit(horizon, step, words):
    with pytest.raises(RulecError) as caught:
        timing(horizon, step)
    (problem,) = caught.value.diagnostics
    assert problem.code == "R0606"
    assert words in problem.message
    assert problem.expected


def test_a_step_that_would_fit_is_named():
    with pytest.raises(RulecError) as caught:
        timing(4.0, 0.3)
    assert (
        "a step of 0.25 s or 0.4 s would fit, or a horizon of 3.9 s"
        in caught.value.diagnostics[0].help
    )
