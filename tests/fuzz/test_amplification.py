"""The worst files of every format are refused, or judged with what their bytes pay for."""

import pytest

from support.mutations.amplification import cost_of
from support.mutations.worst_files import WORST

QUICK = ("tracks: parked at one place", "scenarionet: shared tuples")


def assert_paid_for(name, size, folder):
    cost = cost_of(WORST[name](size), folder)
    assert cost.status in (0, 1, 2), cost.said
    assert "Traceback" not in cost.said
    is_refused = cost.status == 2 and "error[R0718]" in cost.said
    assert cost.held <= cost.may_hold or is_refused, cost
    assert cost.seconds <= cost.may_take_s or is_refused, cost


@pytest.mark.parametrize("name", QUICK)
def test_a_small_one(name, tmp_path):
    assert_paid_for(name, 4, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("name", WORST)
def test_each(name, tmp_path):
    assert_paid_for(name, 20, tmp_path)
