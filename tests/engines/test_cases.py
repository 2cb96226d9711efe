"""What has been thought out by hand, every engine says."""

import pytest

from support.cases.all_cases import CASES
from support.engines.engine import is_right
from support.engines.engine_table import ENGINES

TAKE_SPOT = {"the past inside of the future"}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.spot] if name in TAKE_SPOT else []) for name in CASES],
)
def test_a_case(name, engine):
    case, judges = CASES[name], ENGINES[engine]
    asked = [
        (trace, expected)
        for trace, expected in zip(case.traces, case.expected, strict=True)
        if judges.takes(trace, expected)
    ]
    found = judges.judge(case.rulebook, case.compiled, [trace for trace, _ in asked])
    for (trace, expected), answer in zip(asked, found, strict=True):
        assert is_right(answer, judges.says(expected)), (trace, answer, expected)
