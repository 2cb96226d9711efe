"""`rulec verify` of recorded traffic, as the user meets it."""

import gzip
import json
import shlex
from pathlib import Path
from xml.etree import ElementTree

import pytest

from rulec.cli.main import main
from support.builders.recorded_cars import three_cars

BOOK = """\
rulebook tiny
use road
traffic left

hard rule slow {
  cite "Art. 1"
  says "Drive slowly out of town."
  require always (speed <= 45 km/h or built_up)
}

soft rule distance (v: vehicle) {
  says "Keep 5 m."
  require always (behind(v) and same_lane(v) implies gap(v) >= 5 m)
}
"""

DEFAULTS = ("--assume", "defaults")
MIRRORED = [
    "  recorded where traffic keeps to the right, judged as if it kept to the left",
]


@pytest.fixture
def verify(tmp_path, capsys):
    book = tmp_path / "tiny.rules"
    book.write_text(BOOK)
    file = three_cars(tmp_path)

    def run(*arguments, files=(file,)):
        status = main(["verify", *files, "-r", str(book), *arguments])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


def test_what_was_found_comes_first(verify):
    # 4 drives 50.4 km/h, and is 4 m behind 3, which gets 2 m/s nearer
    status, out, err = verify(*DEFAULTS)
    assert (status, out.partition("see it: ")[0].splitlines()) == (
        1,
        [
            "DEU_Road-1_1_T-1: 3 drives in steps of 0.1 s",
            *MIRRORED,
            "  assumed: defaults, and that nothing comes after the recording's end",
            "1 drive broke a hard rule",
            "  slow [Art. 1]: 1 drive",
            "    Drive slowly out of town.",
            "    by default: built_up",
            "    4  0-2.9 s  speed 50.4 km/h > 45.0 km/h",
            "1 drive broke a soft rule",
            "  distance: 1 drive",
            "    Keep 5 m.",
            "    4  0-2 s  gap(3) 4 m < 5 m",
            "2 drives: nothing against all 2 rules",
            "more: --explain 1 (the first one)",
        ],
    )
    assert err == ""


def test_the_first_violation_is_explained(verify):
    _, out, _ = verify("--explain", "1", *DEFAULTS)
    assert "4: violated" in out.splitlines()
    assert (
        "  hard rule slow [Art. 1]: cannot be kept any more after state 0 (0 s)" in out.splitlines()
    )
    _, out, _ = verify("--as-recorded")
    assert "mirrored" not in out


def test_the_first_rule_is_the_one_that_is_explained(tmp_path, capsys):
    # 3 drives 43 km/h; 4, the next one of the file, is as fast, and alone has somebody near ahead
    book = tmp_path / "rows.rules"
    distance = (
        "hard rule distance (v: vehicle) { require always (behind(v) implies gap(v) >= 5 m) }"
    )
    slow = "hard rule slow { require always speed <= 20 km/h }"
    book.write_text(f"rulebook rows\nuse road\n{distance}\n{slow}\n")
    main(["verify", three_cars(tmp_path), "-r", str(book), "--explain", "1", *DEFAULTS])
    lines = capsys.readouterr().out.splitlines()
    rows = [
        line.split(":")[0].strip() for line in lines if line.endswith((": 2 drives", ": 1 drive"))
    ]
    explained = next(line for line in lines if line.startswith("  hard rule "))
    assert len(rows) == 2
    assert explained.split()[2].rstrip(":") == rows[0] == "slow"


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [("nothere.csv", None, "no such file"), ("cars.parquet", "track,t,x,y\n", "not Parquet")],
)
def test_a_file_that_is_missing_or_misnamed_is_named(tmp_path, capsys, name, text, said):
    if text is not None:
        (tmp_path / name).write_text(text)
    file = str(tmp_path / name)
    assert main(["verify", file, "--map", three_cars(tmp_path), "-r", "esterle2019"]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert name in err


def test_what_is_assumed_is_not_missing(verify):
    status, out, _ = verify("--assume", "built_up=true")
    assert status == 0
    assert "by default" not in out
    assert "2 drives: nothing against all 2 rules" in out.splitlines()


@pytest.mark.parametrize("folder", ["", "a folder/of recordings with a rather long name/"])
def test_the_command_that_draws_has_the_options_that_were_given(
    folder, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    Path("tiny.rules").write_text(BOOK)
    (tmp_path / folder).mkdir(parents=True, exist_ok=True)
    file = folder + Path(three_cars(tmp_path / folder)).name
    options = ["-r", "./tiny.rules", "--as-recorded", "--assume", "built_up=false"]
    assert main(["verify", file, *options]) == 1
    out = capsys.readouterr().out
    command = shlex.split(out.partition("see it: ")[2].replace("\\\n", ""))
    assert command[:4] == ["rulec", "draw", "drive", file]
    assert {"--as-recorded", "built_up=false"} < {*command}
    assert max(map(len, out.splitlines())) <= 80
    assert main(command[1:]) == 0
    assert Path("drive.html").exists()


def test_a_line_of_json_for_each_drive(verify):
    status, out, _ = verify("--json", "--ego", "4", "--ego", "5", *DEFAULTS)
    first, second = map(json.loads, out.splitlines())
    assert status == 1
    assert first["law"].pop("at") == second["law"]["at"]
    assert first["law"].pop("rulebook_hash") == second["law"]["rulebook_hash"]
    assert {name: first[name] for name in first if name != "violations"} == {
        "version": 1,
        "trace": "4",
        "rulebook": "tiny",
        "law": {"law": "", "as_of": ""},
        "satisfied": False,
        "open": [],
        "not_judged": [],
        "kept_regardless": [],
        "presumed": [],
        "recording": "DEU_Road-1_1_T-1",
        "mirrored": True,
        "start_s": 0.0,
        "step_s": 0.1,
        "by_default": ["built_up"],
        "judged": ["slow", "distance"],
    }
    slow, distance = first["violations"]
    assert (slow["rule"], slow["step"], slow["time_s"], slow["by_default"]) == (
        "slow",
        0,
        0.0,
        ["built_up"],
    )
    assert (distance["binding"], distance["by_default"]) == ({"v": "3"}, [])
    assert (second["trace"], second["satisfied"], second["violations"]) == ("5", True, [])


def test_a_threshold(verify):
    # 50.4 km/h is standing, if one likes
    for at, expected in (("50", ["slow", "distance"]), ("51", ["distance"])):
        _, out, _ = verify("--json", "--ego", "4", "--threshold", f"standing_kmh={at}", *DEFAULTS)
        assert [one["rule"] for one in json.loads(out)["violations"]] == expected


def test_recordings_and_traces_together(verify, tmp_path):
    file = three_cars(tmp_path)
    traces = tmp_path / "traces.jsonl"
    traces.write_text('{"id": "t", "step_s": 0.1, "states": [{"speed": 20}]}\n')
    status, out, _ = verify("--explain", "0", *DEFAULTS, files=(str(traces), file))
    assert status == 1
    lines = out.splitlines()
    assert "2 drives: nothing against all 2 rules" in lines
    assert lines[-1] == "1 trace: 1 satisfied, 0 violated"


def test_what_is_no_recording(verify, tmp_path):
    bad = tmp_path / "bad.xml"
    bad.write_text("<commonRoad")
    status, out, err = verify("--json", files=(str(bad), three_cars(tmp_path)))
    assert (status, len(out.splitlines())) == (2, 3)
    assert "error[R0610]" in err


def test_a_single_rule_is_counted_as_one(tmp_path, capsys):
    text = "rulebook one\nuse road\nhard rule r { require always speed <= 500 km/h }\n"
    (tmp_path / "one.rules").write_text(text)
    book = str(tmp_path / "one.rules")
    assert main(["verify", three_cars(tmp_path), "-r", book, "--explain", "0"]) == 0
    assert "3 drives: nothing against the rule" in capsys.readouterr().out.splitlines()


def test_what_is_not_told_is_not_taken_for_its_default(verify):
    # Nothing says whether the road is in a town, so nobody can be known to be too fast
    status, out, _ = verify()
    assert status == 0
    lines = out.splitlines()
    at = lines.index("1 of 2 rules not judged in some drive: 1 want built_up")
    assert lines[at - 1] == "2 drives: nothing found in 1 judged rule"
    assert lines[at + 1] == "  `--assume built_up=VALUE` would let 1 of them be judged: true, false"
    assert "satisfied" not in out
    assert "  built_up: slow" in verify("--why")[1].splitlines()
    _, out, _ = verify("--json", "--ego", "4")
    (line,) = map(json.loads, out.splitlines())
    assert line["satisfied"] is None
    assert line["not_judged"] == [
        {"rule": "slow", "strength": "hard", "untold": ["built_up"], "why": ""}
    ]
    (violation,) = line["violations"]
    evidence = violation["evidence"]
    assert (violation["rule"], evidence["measured"]) == ("distance", ["station", "lateral", "gap"])
    assert (evidence["from_s"], evidence["place"]["lanelet"]) == (0.0, "1")


def test_strictly_what_is_open_counts_as_violated(verify, tmp_path):
    traces = tmp_path / "traces.jsonl"
    traces.write_text('{"id": "t", "states": [{"speed": 50, "built_up": null}]}\n')
    status, out, _ = verify(files=(str(traces),))
    assert (status, out.splitlines()[0]) == (0, "t: open")
    assert "depends on built_up: violated if not built_up, kept if built_up" in " ".join(
        out.split()
    )
    assert verify("--strict", files=(str(traces),))[0] == 1
    for options, failures, kind in (
        ((), 0, ("open", "none")),
        (("--strict",), 1, ("fail", "error")),
    ):
        verify(*options, "-o", str(tmp_path / "f.xml"), files=(str(traces),))
        (suite,) = ElementTree.parse(tmp_path / "f.xml").getroot()
        assert int(suite.get("failures")) == failures
        verify(*options, "-o", str(tmp_path / "f.sarif"), files=(str(traces),))
        (run,) = json.loads((tmp_path / "f.sarif").read_text())["runs"]
        assert [(one["kind"], one["level"]) for one in run["results"]] == [kind]


UNTOLD = """\
rulebook untold
use road

soft rule comfort {
  says "Not in fog."
  require never (visibility < 50 m)
}

hard rule fog {
  says "Not in thicker fog."
  require never (visibility < 40 m)
}

hard rule loaded {
  says "Not with a load."
  require never (ego_mass > 3.5 t)
}

hard rule thick_fog {
  says "Not in thick fog."
  require never (visibility < 20 m)
}
"""


def test_rules_without_a_verdict_are_named_hard_ones_first(tmp_path, capsys, monkeypatch):
    book = tmp_path / "untold.rules"
    book.write_text(UNTOLD)
    assert main(["verify", three_cars(tmp_path), "-r", str(book), "--why"]) == 2
    lines = capsys.readouterr().out.splitlines()
    at = lines.index("4 of 4 rules not judged: 3 want visibility, 1 ego_mass")
    # Neither is a word that one would give a value throughout
    assert lines[at + 1 : at + 5] == [
        "not judged, for lack of (`rulec explain WORD` says what can provide a word):",
        "  visibility: fog, thick_fog",
        "  ego_mass: loaded",
        "  visibility: comfort (soft)",
    ]
    monkeypatch.setattr("rulec.cli.commands.traffic.verify.page_width", lambda: 40)
    main(["verify", three_cars(tmp_path), "-r", str(book)])
    lines = capsys.readouterr().out.splitlines()
    assert lines[lines.index("4 of 4 rules not judged: 3 want") + 1] == "  visibility, 1 ego_mass"


def test_of_what_is_known_as_an_interval_evidence_has_the_bounds(tmp_path, capsys):
    # 4 has been behind 3 since it was seen first, and for how long before nobody knows
    book = tmp_path / "behind.rules"
    book.write_text(
        "rulebook behind\nuse road\nextends schemas\n"
        "hard rule short (v: vehicle) { require always ahead_for(v) < 1 s }\n"
    )
    main(["verify", three_cars(tmp_path), "-r", str(book), "--ego", "4", "--json"])
    violations = json.loads(capsys.readouterr().out)["violations"]
    violation = next(one for one in violations if one["binding"] == {"v": "3"})
    (margin,) = violation["evidence"]["margins"]
    bounds = margin["value"]
    assert 1.0 <= bounds["from"] < 3.0
    assert bounds["to"] == 1000.0
    assert (margin["limit"], margin["value_error"]) == (1.0, 0.0)
    assert margin["by"] == margin["at_least"] == pytest.approx(bounds["from"] - 1.0, abs=1e-9)


@pytest.mark.parametrize("cut", ["cut.csv.gz", "cut.xml.gz"])
def test_a_packed_file_that_was_cut_short_does_not_keep_others_from_being_judged(
    cut, verify, tmp_path
):
    broken = tmp_path / cut
    packed = gzip.compress(b"track,t,x,y\n" * 9_000)
    broken.write_bytes(packed[:20])  # before its first letter
    whole = three_cars(tmp_path)
    status, out, err = verify("--explain", "0", files=(str(broken), whole))
    assert status == 2
    assert err.count("R0701]: the file cannot be read: it is packed, and ends too soon") == 1
    assert "3 drives: 2 satisfied, 0 violated, 1 only soft rules" in " ".join(out.split())
    assert "not read    1 file, as said above" in out
