"""``rulec list formats`` as its user meets it."""

import json
import re

import pytest

from rulec.cli.main import main
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.recordings.format_table import FORMATS
from rulec.recordings.map_files import MAP_FORMATS
from support.unwrapped import unwrapped


@pytest.fixture
def listed(capsys):
    def run(*arguments):
        status = main(["list", "formats", *arguments])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


def named(part):
    """Each format's name, with what is said of it."""
    about = re.split(r"^  (?=\S)", part, flags=re.MULTILINE)[1:]
    return {text.split()[0]: unwrapped(text) for text in about}


def test_every_format_is_listed(listed):
    status, out, err = listed()
    assert (status, err) == (0, "")
    recordings, maps = out.split("\n\n")
    assert recordings.splitlines()[0] == "recordings"
    assert list(named(recordings)) == [x.name for x in FORMATS]
    assert list(named(maps)) == [x.name for x in MAP_FORMATS]
    assert "map: beside it, or --map" in named(recordings)["sumo"]
    assert "map: its own, or --map" in named(recordings)["osi"]
    assert "--map" not in named(recordings)["commonroad"]


def test_some_formats(listed):
    # SUMO has recordings and maps
    status, out, _ = listed("sumo")
    assert status == 0
    recordings, maps = out.split("\n\n")
    assert [list(named(recordings)), list(named(maps))] == [["sumo"], ["sumo"]]


def test_words_that_one_tells_and_the_other_does_not(listed):
    status, out, _ = listed("commonroad", "sumo", "--words")
    assert status == 0
    rows = {line.split()[0]: line.split()[1:] for line in out.splitlines() if line.startswith("  ")}
    assert (rows["1"], rows["2"]) == (["commonroad"], ["sumo"])
    assert rows["word"] == ["1", "2"]
    # SUMO has no weather, CommonRoad no bus stops; what ego weighs nobody tells
    assert rows["wet"] == ["x", "."]
    assert rows["boarding"] == [".", "x"]
    assert rows["ego_mass"] == [".", "."]
    # The word of another vocabulary comes behind those of `road`.
    assert rows["CONGESTED"] == ["x", "x"]


def test_json_has_all_of_it(listed):
    status, out, _ = listed("--json")
    assert status == 0
    document = json.loads(out)
    assert [one["name"] for one in document["recordings"]] == [form.name for form in FORMATS]
    assert [one["takes_map"] for one in document["recordings"]] == [x.takes_map for x in FORMATS]
    assert {one["name"]: set(one["words"] or ()) for one in document["recordings"]} == {
        form.name: set(TELLABLE_WORDS.get(form.name, ())) for form in FORMATS
    }
    assert [one["files"] for one in document["maps"]] == [form.files for form in MAP_FORMATS]


def test_the_end_of_the_file_says_the_format(listed, tmp_path):
    page = tmp_path / "formats.md"
    assert listed("sumo", "--words", "-o", str(page)) == (0, f"wrote {page}\n", "")
    text = page.read_text()
    assert (
        "| SUMO's floating-car data, with their net | `sumo` | "
        "\\*.xml, \\*.csv, \\*.parquet | beside it, or `--map` |" in text
    )
    assert "| `wet` |  |" in text
    assert listed("-o", str(tmp_path / "formats.json"))[0] == 0
    assert json.loads((tmp_path / "formats.json").read_text())["version"] == 1


def test_an_ending_that_says_nothing(listed, tmp_path):
    file = tmp_path / "formats.xlsx"
    status, out, err = listed("-o", str(file))
    assert (status, out) == (2, "")
    assert "does not say by its ending what to write" in err
    assert "one of .txt, .md, .markdown, .json" in err
    assert not file.exists()
    assert listed("-o", str(file), "--output-format", "json")[0] == 0
    assert json.loads(file.read_text())["version"] == 1


def test_two_formats_at_once(listed):
    status, _, err = listed("--json", "--output-format", "markdown")
    assert (status, "contradict each other" in err) == (2, True)


def test_a_misspelt_format(listed):
    status, out, err = listed("comonroad")
    assert (status, out) == (2, "")
    assert "there is no format `comonroad`; did you mean `commonroad`?" in err
