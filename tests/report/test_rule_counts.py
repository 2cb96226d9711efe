"""The counts of rules above a table, against what the table shows."""

import re
from dataclasses import dataclass

from hypothesis import given
from hypothesis import strategies as st

from rulec.report.verdicts.verdict_report import rule_counts


@dataclass(frozen=True)
class Named:
    name: str


RULES = [Named(f"r{number}") for number in range(6)]
SOME = st.sets(st.sampled_from([rule.name for rule in RULES]))


@given(SOME, SOME)
def test_each_rule_is_counted_once(judged, open_in):
    text = rule_counts(RULES, judged, open_in, "this recording")
    number = {
        word: int(n) for n, word in re.findall(r"(\d+) (rules|judged|of them|open|cannot)", text)
    }
    never = len(RULES) - len(judged | open_in)
    assert number["judged"] == len(judged)
    assert number.get("open", 0) == len(open_in - judged)
    assert number.get("of them", 0) == len(open_in & judged)
    assert number.get("cannot", 0) == never
    assert number["judged"] + number.get("open", 0) + never == number["rules"]
