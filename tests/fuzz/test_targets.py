"""Every verb, on inputs with mistakes in them: an answer or a refusal, never a bug or a hang."""

import os
import time
from itertools import count

import pytest

from support.fuzz.targets import TARGETS
from support.fuzz.trial import tried

IS_LONG = os.environ.get("RULEC_TEST_PROFILE") == "long"
AN_HOUR_S = 3600
A_FEW = 40
"""In the quick profile the same ones each time; those that have failed once are among them."""
FEWER = {"odd_worlds": 12}
"""One of these takes as long as ten of others."""
FAILED_ONCE = {"arguments": (186, 285, 313), "tables": (994344,)}


@pytest.mark.parametrize("target", TARGETS)
def test_it_answers_or_refuses(target, tmp_path):
    if IS_LONG:
        seconds = AN_HOUR_S / len(TARGETS)
        trial = tried(target, tmp_path, count(time.time_ns() % 10**9), seconds)
    else:
        trial = tried(
            target, tmp_path, (*range(FEWER.get(target, A_FEW)), *FAILED_ONCE.get(target, ()))
        )
    assert trial.failures == {}
    assert trial.inputs
    assert set(trial.statuses) != {0}
