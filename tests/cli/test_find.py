"""``rulec find``: the moments at which a formula holds."""

import csv
import json
import re
from pathlib import Path

import pyarrow.parquet
import pytest

from rulec.cli.main import main
from rulec.diagnostics import RulecError
from rulec.rulebook.query_reader import read_query
from rulec.trace.formats import trace_files
from rulec.trace.formats.trace_files import read_chunks
from support.unwrapped import unwrapped

BOOK = """
rulebook streets
type car
signal wet default false
signal near(c: car) default false
quantity gap(c: car) in m
param close : length = 5 m
define too_near(c: car) = near(c) and gap(c) < close
hard rule r (c: car) { require never too_near(c) }
"""
DRIVES = [
    {
        "id": "t",
        "step_s": 0.5,
        "ends": "complete",
        "objects": {"a": "car", "b": "car"},
        "present": {"b": [1, 3]},
        "states": [
            {"near": {"a": True}, "gap": {"a": 4}, "wet": True},
            {"near": {"a": True, "b": True}, "gap": {"a": 4.5, "b": 9}},
            {"near": {"a": True, "b": None}, "gap": {"a": 5, "b": 1}},
            {"near": {"b": True}, "gap": {"a": 1, "b": 1}, "wet": True},
        ],
    }
]


@pytest.fixture
def files(tmp_path):
    book, drives = tmp_path / "streets.rules", tmp_path / "t.jsonl"
    book.write_text(BOOK)
    drives.write_text("".join(f"{json.dumps(drive)}\n" for drive in DRIVES))
    return str(book), str(drives)


def found(files, formula, capsys, *options, status=0):
    book, drives = files
    assert main(["find", formula, drives, "-r", book, "--json", *options]) == status
    lines = map(json.loads, capsys.readouterr().out.splitlines())
    return [
        (*one["objects"].values(), one["first_state"], one["last_state"], one["holds"])
        for one in lines
    ]


FORMULAS = {
    "(c: car) too_near(c)": [
        ("a", 0, 1, "surely"),
        ("b", 2, 2, "perhaps"),
        ("b", 3, 3, "surely"),
    ],
    "wet": [(0, 0, "surely"), (3, 3, "surely")],
    "wet and next not wet": [(0, 0, "surely")],
    "eventually[<= 0.5 s] wet": [(0, 0, "surely"), (2, 3, "surely")],
    # One step or two: in the second state only two reach a wet one
    "eventually[<= 0.7 s] wet": [(0, 0, "surely"), (2, 3, "surely")],
    "(c: car) previously near(c)": [
        ("a", 1, 3, "surely"),
        ("b", 2, 2, "surely"),
        ("b", 3, 3, "perhaps"),
    ],
    "some c: car (near(c) and gap(c) < 2 m)": [(2, 2, "perhaps"), (3, 3, "surely")],
    "(c: car, d: car) near(c) and gap(d) = 9 m": [("a", "b", 1, 1, "surely")],
    "never wet": [],
}


@pytest.mark.parametrize("formula", FORMULAS)
def test_moments_by_hand(files, formula, capsys):
    assert found(files, formula, capsys) == FORMULAS[formula]


def test_a_drive_in_seconds_goes_on_unseen(files, capsys):
    book, drives = files
    unsaid = Path(drives).read_text().replace('"ends": "complete", ', "")
    Path(drives).write_text(unsaid)
    moments = found((book, drives), "wet and next not wet", capsys)
    assert moments == [(0, 0, "surely"), (3, 3, "perhaps")]
    before = found((book, drives), "(c: car) previously near(c)", capsys)
    assert before[:2] == [("a", 0, 0, "perhaps"), ("a", 1, 3, "surely")]


def test_only_what_is_sure(files, capsys):
    moments = found(files, "(c: car) too_near(c)", capsys, "--sure")
    assert moments == [("a", 0, 1, "surely"), ("b", 3, 3, "surely")]


def test_lines_and_times(files, capsys):
    book, drives = files
    assert main(["find", "(c: car) too_near(c)", drives, "-r", book]) == 0
    assert unwrapped(capsys.readouterr().out) == (
        f"{drives}: t c=a: 0 to 0.5 s (states 0 to 1) "
        f"{drives}: t c=b: at 1 s (state 2), perhaps "
        f"{drives}: t c=b: at 1.5 s (state 3) "
        "2 moments, 1 more perhaps, in 1 of 1 drive"
    )


@pytest.mark.parametrize("ending", ["csv", "jsonl", "parquet"])
def test_tables(files, tmp_path, ending):
    book, drives = files
    path = tmp_path / f"moments.{ending}"
    assert main(["find", "(c: car) too_near(c)", drives, "-r", book, "-o", str(path)]) == 0
    if ending == "csv":
        rows = list(csv.DictReader(path.read_text().splitlines()))
        objects = [row["objects"] for row in rows]
    elif ending == "jsonl":
        rows = [json.loads(line) for line in path.read_text().splitlines()]
        objects = [f"c={row['objects']['c']}" for row in rows]
    else:
        rows = pyarrow.parquet.read_table(path).to_pylist()
        objects = ["; ".join(row["objects"]) for row in rows]
    assert objects == ["c=a", "c=b", "c=b"]
    assert [float(row["from_s"]) for row in rows] == [0.0, 1.0, 1.5]
    assert [int(row["last_state"]) for row in rows] == [1, 2, 3]


BAD = {
    "what is no formula": ("near(", "R0104"),
    "an unknown name": ("dry", "R0202"),
    "a variable without a type": ("near(c)", "before the formula"),
    "a number": ("5 m", "R03"),
    "a second rule": ("wet } hard rule s { require wet", "R0104"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_wrong_is_said(files, case, capsys):
    book, drives = files
    formula, code = BAD[case]
    assert main(["find", formula, drives, "-r", book]) == 2
    assert code in capsys.readouterr().err


LISTS = "`rulec list vocabularies` says where words are"
PLACES = {
    ("-u", "NOSUCH", "wet"): ["there is no vocabulary `NOSUCH`"],
    ("-u", "road hard", "wet"): ["there is no vocabulary `road hard`"],
    ("built_up and dry",): [" --> the formula:1:14", "1 | built_up and dry"],
    ("(v: lorry)\n not near(",): [" --> the formula:2:11", "2 |  not near("],
    ("(v: lorry) gap(v) < 5 m",): [" --> the formula:1:5", "1 | (v: lorry) gap(v) < 5 m"],
}


@pytest.mark.parametrize("case", PLACES)
def test_only_what_somebody_has_written_is_shown(files, case, capsys):
    *options, formula = case
    assert main(["find", *options, "--", formula, files[1]]) == 2
    told = capsys.readouterr().err
    shown = [line for line in told.splitlines() if line.startswith((" -->", "1 |", "2 |"))]
    assert PLACES[case] == (shown or [told.splitlines()[0].partition(": ")[2]])
    assert "what_is_asked" not in told


@pytest.mark.parametrize(
    ("formula", "way_out"),
    [
        ("R_cw", "it is a word of the vocabulary `paper`: `--use paper`"),
        (
            "(v: vehicle) is_passed_by(v)",
            "it is defined in the rulebook `schemas`: `--rulebook schemas`",
        ),
        (
            "drunk",
            f"{LISTS}; those of a rulebook take `--rulebook NAME`",
        ),
    ],
)
def test_a_word_from_elsewhere_is_had_by_an_option(files, formula, way_out, capsys):
    assert main(["find", formula, files[1]]) == 2
    assert f"= help: {way_out}\n" in capsys.readouterr().err


def test_the_formula_stands_before_the_files(files, capsys):
    _, drives = files
    assert main(["find", drives, "speed > 50 km/h"]) == 2
    said = f"`{drives}` is a file: the formula comes first, as in `rulec find 'speed > 50 km/h' "
    assert said in capsys.readouterr().err


def test_a_name_that_the_words_lack(files, capsys):
    assert main(["find", "(v: lorry) built_up", files[1]]) == 2
    assert "the formula says nothing about `v`" in capsys.readouterr().err
    assert main(["find", "built_up", files[1]]) == 2
    assert "which `road` does not know" in capsys.readouterr().err


def test_a_trace_that_does_not_fit_is_said_and_others_are_asked(files, tmp_path, capsys):
    book, drives = files
    odd = tmp_path / "odd.jsonl"
    odd.write_text(
        '{"id": "odd", "states": [{"wet": 7}]}\n{"id": "wet", "states": [{"wet": true}]}'
    )
    assert main(["find", "wet", str(odd), drives, "-r", book]) == 2
    printed = capsys.readouterr()
    assert "R0503" in printed.err
    assert "3 moments, in 2 of 2 drives" in printed.out


def test_a_vocabulary_by_its_name(tmp_path, capsys):
    path = tmp_path / "fast.jsonl"
    path.write_text(
        '{"states": [{"speed": 60, "built_up": true}, {"speed": 40, "built_up": true}]}'
    )
    assert main(["find", "built_up and speed > 50 km/h", str(path)]) == 0
    assert "at 0 s (state 0)" in capsys.readouterr().out


def test_traces_are_asked_while_they_are_read(files, monkeypatch, capsys):
    """A second chunk is read only after what the first one holds has been told."""

    def chunks(stream, file, form):
        told.append(capsys.readouterr().out)
        (chunk,) = read_chunks(stream, file, form)
        yield chunk
        told.append(capsys.readouterr().out)

    told = []
    monkeypatch.setattr(trace_files, "read_chunks", chunks)
    book, drives = files
    assert main(["find", "wet", drives, "-r", book]) == 0
    before, after = told
    assert not before
    assert "state 0" in after


def test_words_of_a_vocabulary_beside_those_of_a_rulebook(files, capsys):
    """Neither option makes the other one void, and a name that both have is refused."""
    asked = "(c: car) too_near(c) and not CONGESTED"
    assert found(files, asked, capsys, "-u", "paper") == FORMULAS["(c: car) too_near(c)"]
    book, drives = files
    assert main(["find", asked, drives, "-r", book]) == 2
    assert "nothing is called `CONGESTED`" in capsys.readouterr().err
    assert main(["find", "wet", drives, "-r", book, "-u", "road"]) == 2
    assert "the name `wet` is declared twice" in capsys.readouterr().err


OF_A_RULE = re.compile(r"\brule\b|what_is_asked")


def said_of(formula):
    """The texts of a formula's mistakes."""
    try:
        read_query(formula, vocabulary="paper")
    except RulecError as error:
        found = error.diagnostics
        return [" ".join([one.message, one.expected, one.help, *one.notes]) for one in found]
    return []


def test_no_message_about_a_formula_speaks_of_a_rule():
    """Formulas of rulebooks with mistakes, with and without their variables."""
    bad = Path(__file__).parents[1] / "programs" / "bad"
    texts = [path.read_bytes().decode(errors="replace") for path in sorted(bad.glob("*.rules"))]
    rule = r"rule \w+\s*(\([^)]*\))?[^{}\n]*\{\s*require (.*?)\s*\}"
    asked = [(head, formula) for text in texts for head, formula in re.findall(rule, text)]
    both = sorted({*asked, *(("", formula) for _, formula in asked)})
    said = [text for head, formula in both for text in said_of(f"{head} {formula}")]
    assert len(said) > 300
    assert "the formula has no variable `v` expected a variable of the formula" in " ".join(said)
    assert not [
        text for text in said if OF_A_RULE.search(re.sub(r"`(?!what_)[^`]*`|\(.*?\)", "", text))
    ]
