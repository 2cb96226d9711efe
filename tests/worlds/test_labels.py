"""Recorded traffic with labels from raw places: who surely broke a rule is found, and nobody else.

The files are those that RULEC_RECORDINGS names; in the long run of the tests.
"""

import os

import pytest

from support.builders.recorded_data import RECORDINGS
from support.worlds.judging import judged_recordings
from support.worlds.not_yet import LABELS
from support.worlds.scoring import Score

FILES = sorted(RECORDINGS.glob("*.xml")) + sorted(RECORDINGS.parent.glob("*_more/*.xml"))
pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long" or not FILES,
    reason="takes a while, and recordings: --long, and RULEC_RECORDINGS",
)


def test_sure_labels():
    total = {}
    for by_rule in judged_recordings(FILES).values():
        for rule, score in by_rule.items():
            total.setdefault(rule, Score()).add(score)
    for rule, score in total.items():
        most_false, most_missed = LABELS.get(rule, (0, 0))
        assert len(score.false) <= most_false, score.false
        assert score.planted - score.found <= most_missed, score.missed
