"""``rulec verify`` of many files, and what it writes into files."""

import csv
import gzip
import io
import json
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from rulec import Session
from rulec.cli.main import main
from support.builders.recorded_cars import three_cars

BOOK = """\
rulebook tiny
use road

hard rule slow {
  cite "Art. 1"
  require always speed <= 45 km/h
}

hard rule quiet { require never wet }
"""


@pytest.fixture
def verify(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("tiny.rules").write_text(BOOK)
    (tmp_path / "drives").mkdir()
    text = Path(three_cars(tmp_path / "drives")).read_text()
    Path("drives/b.xml.gz").write_bytes(gzip.compress(text.encode()))
    Path("drives/broken.xml").write_text(text[:-300])
    Path("drives/notes.txt").write_text("no traffic")

    def run(*arguments):
        status = main(["verify", *arguments, "-r", "./tiny.rules"])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


A = "drives/DEU_Road-1_1_T-1.xml"
# 3 drives 43.2 km/h, 4 drives 50.4 km/h; whether it is wet the file does not say.
TABLE = """\
drives/DEU_Road-1_1_T-1.xml: 3 drives: 1 violated, 2 nothing found (slow 1)
drives/b.xml.gz: 3 drives: 1 violated, 2 nothing found (slow 1)

altogether  2 recordings with 6 drives
not read    1 file, as said above
rules       2 rules: 1 judged, 1 cannot be judged from these recordings

violated              drives   recordings
slow [Art. 1]  hard      2/6          2/2
  first: 4 at 0 s in drives/DEU_Road-1_1_T-1.xml
6 drives: 2 violated, 4 nothing found
"""


def test_a_folder_is_a_line_for_each_recording_and_one_table(verify):
    status, out, err = verify("drives")
    assert (status, out) == (2, TABLE)
    assert err.startswith(
        "rulec: 3 recordings in drives; left alone: 1 without recorded traffic (drives/notes.txt)\n"
    )
    assert "error[R0610]" in err
    assert "drives/broken.xml" in err


def test_a_single_recording_has_no_table_and_is_explained_on_request(verify):
    status, out, _ = verify(A)
    assert status == 1
    assert out.startswith("DEU_Road-1_1_T-1: 3 drives")
    assert "altogether" not in out
    assert "kept if" not in out
    assert "kept if" in verify(A, "--explain", "1")[1]


def test_explanations_are_counted_by_file(verify):
    _, out, _ = verify("drives/[Db]*", "--explain", "1")
    assert out.count("kept if") == 2


def test_output_does_not_depend_on_the_number_of_processes(verify):
    _, alone, _ = verify("drives", "--json")
    _, beside, _ = verify("drives", "--json", "-j", "4")
    assert alone == beside
    assert len(alone.splitlines()) == 6


def test_several_files_at_once(verify):
    outputs = [f"found.{end}" for end in ("jsonl", "csv", "parquet", "xml", "sarif")]
    options = [word for name in outputs for word in ("-o", name)]
    status, out, _ = verify("drives", *options)
    assert status == 2
    # In each recording 4 violates `slow` and `quiet` is not judged; a third could not be read.
    assert out == TABLE + "".join(f"wrote 5 findings to {name}\n" for name in outputs)
    lines = [json.loads(line) for line in Path("found.jsonl").read_text().splitlines()]
    assert [(line["file"], line["rule"], line["outcome"]) for line in lines] == [
        (A, "slow", "violated"),
        (A, "quiet", "not_judged"),
        ("drives/b.xml.gz", "slow", "violated"),
        ("drives/b.xml.gz", "quiet", "not_judged"),
        ("drives/broken.xml", "", "not_judged"),
    ]
    # 50.4 km/h instead of 45 all along, 2.9 s in steps of 0.1 s, from x = 2 m on
    first = lines[0]
    assert (first["vehicle"], first["from_s"], first["to_s"]) == ("4", 0.0, 2.9)
    # It is lost at once, and the digits are those that were measured
    assert (first["at_s"], first["by"]) == (0.0, 5.4)
    assert (first["unit"], first["x"], first["provision"]) == ("km/h", 2.0, "Art. 1")
    with Path("found.csv").open(newline="") as stream:
        assert [row["rule"] for row in csv.DictReader(stream)] == [one["rule"] for one in lines]
    suites = ElementTree.parse("found.xml").getroot().findall("testsuite")
    assert [suite.get("failures") for suite in suites] == ["1", "1", "0"]
    (run,) = json.loads(Path("found.sarif").read_text())["runs"]
    assert len(run["results"]) == 2


def test_findings_on_standard_output(verify):
    status, out, _ = verify(A, "--output-format", "csv")
    assert status == 1
    assert [row["rule"] for row in csv.DictReader(out.splitlines())] == ["slow", "quiet"]


def test_text_and_json_go_to_files_too(verify):
    status, out, _ = verify(A, "-o", "a.txt", "-o", "a.json")
    assert (status, out) == (1, "wrote the answer to a.txt\nwrote the answer to a.json\n")
    assert "\n1 drive broke a hard rule\n" in Path("a.txt").read_text()
    assert len(Path("a.json").read_text().splitlines()) == 3


def test_traces_have_findings_too(verify):
    Path("t.jsonl").write_text(
        '{"id": "t1", "step_s": 0.5, "states": [{"speed": 9}, {"speed": 50}, {"speed": 9}]}\n'
        '{"id": "t2", "states": 3}\n'
    )
    status, _, _ = verify("t.jsonl", "-o", "t.csv")
    assert status == 2
    with Path("t.csv").open(newline="") as stream:
        violated, broken = csv.DictReader(stream)
    assert (violated["vehicle"], violated["rule"], violated["from_s"]) == ("t1", "slow", "0.5")
    assert (broken["rule"], broken["outcome"]) == ("", "not_judged")


def test_packed_traces(verify):
    Path("t.jsonl.gz").write_bytes(gzip.compress(b'{"states": [{"speed": 50}]}\n'))
    assert verify("t.jsonl.gz")[0] == 1


def test_a_recording_on_standard_input(verify, monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(Path(A).read_bytes())))
    status, out, _ = verify("-", "--input-format", "commonroad", "--json")
    assert status == 1
    assert len(out.splitlines()) == 3


def test_a_broken_recording_on_standard_input_has_that_name(verify, monkeypatch):
    broken = io.BytesIO(Path("drives/broken.xml").read_bytes())
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(broken))
    status, _, err = verify("-", "--input-format", "commonroad")
    assert status == 2
    assert "--> standard input" in err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((A, "-o", A), "is named already, and would be overwritten"),
        (("drives", "-o", A), "is recorded traffic, a map, or read along with these"),
        ((A, "-o", "a.csv", "-o", "b.csv", "--json"), "the ending of each decides its format"),
        ((A, "-o", "-", "-o", "-"), "standard output can have only one format"),
        (("drives", "-o", "a.mcap"), "MCAP has one time line"),
        ((A, "-o", "a.xls"), "one of .txt, .json, .jsonl, .ndjson, .csv, .parquet, .pq, .xml"),
    ],
)
def test_what_is_refused(verify, arguments, says):
    before = Path(A).read_text()
    status, out, err = verify(*arguments)
    assert (status, out) == (2, "")
    assert says in err
    assert Path(A).read_text() == before
    assert not list(Path().glob("a.*"))


def test_nothing_is_written_where_the_run_fails(verify):
    Path("a.csv").write_text("old")
    status, _, _ = verify(A, "-o", "a.csv", "-o", "no/folder/b.csv")
    assert status == 2
    assert Path("a.csv").read_text() == "old"


def test_parquet_without_its_package(verify, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    status, out, err = verify(A, "-o", "a.parquet")
    assert (status, out) == (2, "")
    assert "[parquet]'`" in err
    assert not Path("a.parquet").exists()


SLOWER = BOOK.replace("rulebook tiny", "rulebook slower").replace("45 km/h", "40 km/h")
ONE_RULE = "rulebook other\nuse road\nhard rule dry { require always speed >= 0 km/h }\n"


def test_several_rulebooks_side_by_side(verify):
    Path("slower.rules").write_text(SLOWER)
    Path("other.rules").write_text(ONE_RULE)
    status, out, err = verify(
        A, "-r", "./slower.rules", "-r", "./other.rules", "-r", "./slower.rules"
    )
    assert (status, err) == (1, "")
    assert [line.partition(" [")[0] for line in out.splitlines() if line.startswith("by ")] == [
        "by slower",
        "by other",
        "by tiny",
        "by                slower         other  tiny",
    ]
    # 3 drives 43.2 km/h, 4 drives 50.4 km/h, another one slower; of none it is known to be dry.
    assert out.splitlines()[-8:] == [
        "by                slower         other  tiny",
        "─" * 44,
        "slow                   2  no such rule     1",
        "─" * 44,
        "satisfied              0             3     0",
        "violated               2             0     1",
        "nothing found          1             0     2",
        "rules not judged       1             0     1",
    ]


def test_what_is_assumed_need_be_known_to_one_of_several_rulebooks(verify):
    """A word that one law alone has is assumed for it; of a word that none has it is said."""
    own = "rulebook own\nsignal humid\nhard rule damp { require always humid }\n"
    Path("own.rules").write_text(own)
    status, out, err = verify(A, "-r", "./own.rules", "--assume", "humid=false", "--json")
    assert (status, err) == (1, "")
    rules = [[one["rule"] for one in json.loads(x)["violations"]] for x in out.splitlines()]
    assert rules == [["damp"]] * 3 + [[], ["slow"], []]
    status, _, err = verify(A, "-r", "./own.rules", "--assume", "humit=false")
    assert status == 2
    assert "does not know `humit`" in err


def test_several_rulebooks_on_traces_and_in_files(verify):
    Path("slower.rules").write_text(SLOWER)
    Path("t.jsonl").write_text(
        '{"id": "t1", "states": [{"speed": 42, "wet": false}]}\n{"id": "t2", "states": 3}\n'
    )
    status, out, _ = verify("t.jsonl", "-r", "./slower.rules", "-o", "t.csv", "-o", "t.json")
    assert status == 2
    assert "slow                   1  kept\n" in out
    assert "not judged             1     1\n" in out
    lines = [json.loads(line) for line in Path("t.json").read_text().splitlines()]
    assert [(line["rulebook"], line.get("satisfied")) for line in lines] == [
        ("slower", False),
        ("slower", None),
        ("tiny", True),
        ("tiny", None),
    ]
    with Path("t.csv").open(newline="") as stream:
        found = [(row["rulebook"], row["outcome"]) for row in csv.DictReader(stream)]
    assert found == [("slower", "violated"), ("slower", "not_judged"), ("tiny", "not_judged")]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            [A, "-o", "x.sarif"],
            "sarif can contain only one rulebook; for several give one of text, json,",
        ),
        (["-"], "standard input is read once"),
    ],
)
def test_what_does_not_go_with_several_rulebooks(arguments, words, verify):
    Path("slower.rules").write_text(SLOWER)
    status, out, err = verify(*arguments, "-r", "./slower.rules")
    assert (status, out) == (2, "")
    assert words in err


def test_a_rule_that_is_too_large_for_a_recording_s_step_is_a_finding(verify):
    """2,000 s are 20,000 steps of 0.1 s, twice as many as may be."""
    late = "\n\nhard rule late { require always (wet implies eventually[<= 2000 s] not wet) }\n"
    Path("tiny.rules").write_text(BOOK.replace("use road", "use road\nstep 10 s") + late)
    verify("drives/b.xml.gz", "-o", "f.jsonl")
    rows = [json.loads(line) for line in Path("f.jsonl").read_text().splitlines()]
    (row,) = [row for row in rows if row["rule"] == "late"]
    assert (row["outcome"], row["strength"]) == ("not_judged", "hard")
    assert "too large for steps of 0.1 s" in row["because"]


def test_editions_of_one_rulebook_are_told_apart(verify):
    Path("old").mkdir()
    Path("old/tiny.rules").write_text(BOOK.replace("45 km/h", "40 km/h"))
    files = ("-o", "found.csv", "-o", "v.json", "--exposure")
    status, out, err = verify(A, "-r", "./old/tiny.rules", "--explain", "1", *files)
    old, new = "tiny (old/tiny.rules)", "tiny (tiny.rules)"
    assert (status, err) == (1, "")
    headings = [line for line in out.splitlines() if line.startswith("by ")]
    assert [line.partition(" [")[0] for line in headings[:2]] == [f"by {old}", f"by {new}"]
    assert headings[2].split("  ")[-2:] == [old, new]
    # The rules are the editions' own, and are not said to be from another book.
    assert "hard rule slow [Art. 1]:" in out
    lines = [json.loads(line) for line in Path("v.json").read_text().splitlines()]
    assert {line["rulebook"] for line in lines} == {old, new}
    with Path("found.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["rulebook"] for row in rows} == {old, new}
    # Findings of one edition have its hash, whatever it was judged beside.
    verify(A, "-o", "alone.csv", "--exposure")
    with Path("alone.csv").open(newline="") as stream:
        alone = {row["rulebook_hash"] for row in csv.DictReader(stream)}
    assert alone == {row["rulebook_hash"] for row in rows if row["rulebook"] == new}


@pytest.mark.parametrize(
    ("day", "said"),
    [
        ("2020-01-01", "by dated: Act as of 2020-01-01 ["),
        (
            "2026-11-29",
            "by dated: Act as of 2020-01-01, without what has changed until 2026-11-29\n  [",
        ),
        ("2019-05-01", "by dated: Act as of 2020-01-01, as in force on 2019-05-01 ["),
    ],
)
def test_a_verdict_says_by_which_text_it_is(day, said, verify, capsys):
    Path("dated.rules").write_text(
        'rulebook dated\nlaw "Act" as of 2020-01-01\nuse road\n'
        "hard rule calm { require always speed <= 45 km/h }\n"
    )
    outputs = ("-o", "v.sarif", "-o", "v.json", "-o", "-")
    files = [A, "-r", "./dated.rules"]
    assert main(["verify", *files, "--at", day, *outputs, "--explain", "0"]) == 1
    assert capsys.readouterr().out.startswith(said)
    verdicts = [json.loads(line) for line in Path("v.json").read_text().splitlines()]
    (run,) = json.loads(Path("v.sarif").read_text())["runs"]
    laws = [verdict["law"] for verdict in verdicts]
    assert {law["at"] for law in laws} == {day}
    assert run["tool"]["driver"]["properties"] == {"rulebook": "dated", **laws[0]}
    session = Session(at=day)
    (first, *_) = session.verify_recording(A, "dated.rules").answers()
    assert first.answer.law._asdict() == {"rulebook": "dated", **laws[0]}


@pytest.mark.parametrize("options", [["sarif"], ["jsonl"], ["jsonl", "--exposure"], ["csv"]])
def test_times_beyond_all_numbers_are_left_out(options, tmp_path, capsys):
    lines = Path("docs/samples/traces.jsonl").read_text().splitlines()
    file = tmp_path / "long.jsonl"
    file.write_text("".join(f"{json.dumps(json.loads(x) | {'step_s': 1e308})}\n" for x in lines))
    assert main(["verify", str(file), "-r", "esterle2019", "--output-format", *options]) == 1
    written = capsys.readouterr().out
    assert "R1" in written
    assert "Infinity" not in written
    assert ",inf," not in written
