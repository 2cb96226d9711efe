"""`find` and `rates_of_findings` from Python give what the commands give."""

import json

import pytest

import rulec
from rulec.cli.main import main
from support.builders.recorded_cars import three_cars

BOOK = "rulebook slow use road hard rule r { require always speed < 45 km/h }"
FORMULA = "speed >= 45 km/h"


@pytest.fixture(scope="module")
def cars(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cars")
    (folder / "slow.rules").write_text(BOOK)
    return folder, str(three_cars(folder))


def times(found):
    return [
        (one.vehicle, one.time_s(moment.first), one.time_s(moment.last), moment.holds)
        for one in found
        for moment in one.moments
    ]


def test_moments_are_those_of_the_command(cars, capsys):
    _, file = cars
    assert main(["find", FORMULA, file, "--json"]) == 0
    lines = map(json.loads, capsys.readouterr().out.splitlines())
    expected = [(x["vehicle"], x["from_s"], x["to_s"], x["holds"]) for x in lines]
    assert expected
    assert times(rulec.find(FORMULA, file)) == expected
    recording = rulec.read_recording(file)
    assert times(rulec.find(FORMULA, recording)) == expected
    egos = (expected[0][0],)
    own = rulec.find(FORMULA, recording, wanted=rulec.RequestedDrives(egos))
    assert times(own) == [one for one in expected if one[0] in egos]


def test_moments_of_traces_and_of_what_is_none():
    fast = rulec.Trace("t", 1, {}, ({"speed": 60}, {"speed": 1}))
    odd = rulec.Trace("odd", 1, {}, ({"sped": 60},))
    found, error = rulec.find(FORMULA, [fast, odd])
    assert times([found]) == [("t", 0.0, 0.0, "surely")]
    assert error.diagnostics[0].code == "R0502"
    with pytest.raises(rulec.RulecError, match="nothing is called `sped`"):
        rulec.find("sped > 1", [fast])


def test_a_formula_about_an_object_holds_while_it_is_there():
    """The last state goes on for ever, and of who has left that is its last one."""
    states = [{"station": {"a": "behind"}} if k in (1, 2) else {} for k in range(4)]
    left = rulec.Trace("t", 1, {"a": "car"}, states, {"a": (1, 2)})
    for formula in ("weak previously behind(v)", "eventually behind(v)"):
        (found,) = rulec.find(f"(v: vehicle) {formula}", [left])
        assert times([found]) == [("t", 1.0, 2.0, "surely")]


def test_rates_are_those_of_the_command(cars, capsys):
    folder, file = cars
    written = folder / "found.jsonl"
    book = str(folder / "slow.rules")
    assert main(["verify", file, "-r", book, "--exposure", "-o", str(written)]) == 1
    capsys.readouterr()
    assert main(["rates", str(written), "--by", "file", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    (rule,) = rulec.rates_of_findings(written, by=["file"]).rules
    (expected,) = document["rules"]
    assert (rule.opportunities, rule.violated, rule.hours) == (3, 1, expected["hours"])
    assert rule.group == (file,)
    with pytest.raises(rulec.RulecError, match="R0716"):
        rulec.rates_of_findings([written, written])


def test_a_recorded_violation_is_explained_with_what_it_was_decided_by(tmp_path):
    book = tmp_path / "near.rules"
    book.write_text(
        "rulebook near\nuse road\n"
        "hard rule far (v: vehicle) { require always (behind(v) implies gap(v) >= 5 m) }\n"
    )
    verdicts = rulec.verify_recording(three_cars(tmp_path), str(book))
    (found,) = (one for one in verdicts.answers() if one.answer.violations)
    (violation,) = found.answer.violations
    # 4 is 4 m behind 3
    (margin,) = rulec.explain(violation, found.drive, str(book)).margins()
    assert (margin.text, margin.relation, margin.limit) == ("gap(3)", "<", 5.0)
    (same,) = rulec.explain(violation, found.drive.trace, verdicts.rules).margins()
    assert same == margin
