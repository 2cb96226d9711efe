"""What is given of the wrong kind is said at the door, with what to give instead."""

import pytest

import rulec

TRACE = rulec.Trace("t", 1.0, {}, ({"CONGESTED": True},))
FOLLOWING = "docs/samples/following.xml"


@pytest.mark.parametrize(
    ("call", "error", "said"),
    [
        (lambda: rulec.compile_rulebook(None), TypeError, "a Rulebook, not NoneType"),
        (lambda: rulec.verify(TRACE, 3), TypeError, "a Rulebook, not int"),
        (lambda: rulec.verify_many("a.jsonl", "esterle2019"), TypeError, "read_traces"),
        (lambda: rulec.verify_many(TRACE, "esterle2019"), TypeError, "several traces, not Trace"),
        (lambda: rulec.find("CONGESTED", [TRACE], TRACE), TypeError, "name or path, not Trace"),
        (lambda: rulec.find("CONGESTED", {"track": [1]}), TypeError, "not dict: .*from_columns"),
        (lambda: rulec.TrafficWorld(FOLLOWING), TypeError, "read_recording"),
        (lambda: rulec.score([], None, "esterle2019"), TypeError, "a TrafficWorld, not NoneType"),
        (lambda: rulec.rates_of_findings("a", by="raod"), ValueError, "country, road, .*'raod'"),
        (lambda: rulec.rates_of_findings("a", confidence=95), ValueError, "0.95, not 95"),
        (lambda: rulec.write_monitor("esterle2019", "a", language="java"), ValueError, "'java'"),
        (lambda: rulec.draw_drive(FOLLOWING, "de", form="gif"), ValueError, "not 'gif'"),
        (lambda: rulec.load_rulebook("de", at="yesterday"), ValueError, "no day such as"),
        (lambda: rulec.verify(TRACE, "esterle2019", {"ends": 1}), TypeError, "Assumptions, not"),
        (lambda: rulec.verify_many([TRACE], "esterle2019", {}), TypeError, "Assumptions, not dict"),
        (lambda: rulec.find_maneuvers("s2", "de", assumptions="cut"), TypeError, "not str"),
        (lambda: rulec.verify_recording(FOLLOWING, "de", {}), TypeError, "RequestedDrives, not"),
        (lambda: rulec.find("CONGESTED", FOLLOWING, wanted={}), TypeError, "RequestedDrives, not"),
        (lambda: rulec.draw_drive(FOLLOWING, "de", wanted="1"), TypeError, "RequestedDrives, not"),
        (lambda: rulec.draw("x"), TypeError, "is drawn, not str"),
        (lambda: rulec.Assumptions(ends="maybe"), ValueError, "not 'maybe'"),
        (lambda: rulec.Assumptions(values="built_up"), TypeError, "a mapping of names, not str"),
        (lambda: rulec.Thresholds(near_m=-1), ValueError, "`near_m` is a number from 0 .*not -1"),
        (lambda: rulec.Thresholds(near_m="1"), ValueError, "not '1'"),
        (lambda: rulec.Thresholds(near_m=float("nan")), ValueError, "not nan"),
    ],
)
def test_a_wrong_kind_is_said(call, error, said):
    with pytest.raises(error, match=said):
        call()


def test_one_alone_is_as_good_as_a_list():
    one = rulec.diff("esterle2019", "esterle2019", patterns="R1")
    assert [pair.name for pair in one.pairs] == ["R1"]
    assert rulec.RequestedDrives(egos="12").egos == rulec.RequestedDrives(egos=[12]).egos == ("12",)


def test_a_rulebook_in_memory_is_written_in_ltl(tmp_path):
    book = rulec.parse_rulebook("rulebook a signal p hard rule r { require never p }")
    assert next(path.name for path in rulec.write_ltl(book, tmp_path)) == "a.csv"
