"""``rulec explain`` as its user meets it."""

import json
import re
from pathlib import Path

import pytest

from rulec.cli.main import main
from rulec.logic.free_names import names_in
from rulec.report.findings.code_registry import all_codes
from rulec.rulebook.files.words_in_files import rules_reading
from rulec.rulebook.reading.rulebook_reader import load_rulebook


def explain(capsys, *arguments):
    status = main(["explain", *arguments])
    return status, *capsys.readouterr()


@pytest.mark.parametrize("code", ["R0305", "r0305"])
def test_a_code(code, capsys):
    status, out, err = explain(capsys, code)
    assert (status, err) == (0, "")
    assert out == (
        "R0305: a default is not one of the values\n"
        "\n"
        "The default of an enumeration applies where no value is given, so it must be one\n"
        "of the values.\n"
        "\n"
        "Wrong (to check):\n"
        "\n"
        "    rulebook example\n"
        "    light is one of red, green default grean\n"
        "    hard rule r { require always red }\n"
        "\n"
        "Corrected:\n"
        "\n"
        "    rulebook example\n"
        "    light is one of red, green default green\n"
        "    hard rule r { require always red }\n"
    )


@pytest.mark.parametrize(
    ("name", "way_out"),
    [
        ("R2", "it is a rule, which `rulec show esterle2019 R2` explains"),
        ("esterle2019", "it is a rulebook, which `rulec show esterle2019` explains"),
        ("crossing_overtaking", "` explains (also of "),
    ],
)
def test_a_rule_is_shown(name, way_out, capsys):
    status, out, err = explain(capsys, name)
    assert (status, out) == (2, "")
    assert way_out in err.splitlines()[0]


def test_a_rulebook_of_ones_own_is_shown(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("town.rules").write_text("rulebook town use road hard rule a { require always stopped }")
    status, out, err = explain(capsys, "town.rules")
    assert (status, out) == (2, "")
    assert "it is a file, which `rulec show town.rules` explains" in err.splitlines()[0]
    assert "it is a file" not in explain(capsys, "village.rules")[2]


def test_a_code_without_an_example(capsys):
    status, out, _ = explain(capsys, "R0403")
    assert status == 0
    assert "conda-forge" in out
    assert "Wrong" not in out


def test_all_codes(capsys):
    status, out, _ = explain(capsys, "--all")
    assert status == 0
    lines = " ".join(out.split())
    assert all(f"{code.code}: {code.title} " in lines for code in all_codes().values())


def test_json(capsys):
    status, out, _ = explain(capsys, "--all", "--output-format", "json")
    assert status == 0
    listed = json.loads(out)
    assert [one["code"] for one in listed] == list(all_codes())
    first = all_codes()["R0101"]
    assert listed[0] == {
        "version": 1,
        "code": "R0101",
        "title": first.title,
        "why": first.why,
        "kind": "command",
        "bad": first.bad,
        "good": first.good,
    }
    _, out, _ = explain(capsys, "R0504", "--output-format", "json")
    assert [one["code"] for one in json.loads(out)] == ["R0504"]


def test_several_codes(capsys):
    _, out, _ = explain(capsys, "r0602", "R0101", "R0602")
    assert [line[:6] for line in out.splitlines() if line[:2] == "R0"] == ["R0602:", "R0101:"]
    _, out, _ = explain(capsys, "R0602", "R0101", "--output-format", "markdown")
    assert out.count("\n# R0101: ") == 1
    assert out.startswith("# R0602: ")
    status, out, err = explain(capsys, "R9999", "R0602", "speling")
    assert (status, out[:6]) == (2, "R0602:")
    assert [line[:45] for line in err.splitlines()] == [
        "rulec: there is no code and no word `R9999`; ",
        "rulec: there is no code and no word `speling`",
    ]


def test_markdown_of_one_code(capsys):
    _, out, _ = explain(capsys, "R0606", "--output-format", "markdown")
    assert out.startswith("# R0606: horizon and step do not fit together\n\nThe horizon is divided")
    assert "```toml wrong\nhorizon_s = 4.0\n" in out


def test_a_page_has_every_code(capsys):
    status, out, _ = explain(capsys, "--all", "--output-format", "markdown")
    assert status == 0
    assert out.startswith("# Codes\n\n## R01: syntax\n\n### R0101: a file is not a text in UTF-8\n")
    assert re.findall(r"^### (R\d{4}): ", out, re.M) == [*all_codes()]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["R0602x"], "there is no code and no word `R0602x`; did you mean `R0602`?"),
        (["trikk"], "words that may mean it: `tram`, `tram_track` (ego drives on a tram track)\n"),
        (["fußgängerzone"], "did you mean `pedestrian_zone` (ego is in a pedestrian zone)?"),
        (["spead"], "did you mean the word `speed`?"),
        (["R9"], "there is no code and no word `R9`; `rulec list codes` shows all codes"),
        (["speling"], "`rulec list codes` shows all codes, and `rulec list vocabularies`"),
        (["verify"], "it is a command, which `rulec help verify` explains"),
        (["analyse"], "did you mean the command `analyze`, which `rulec help analyze` explains?"),
        (
            ["lights"],
            "it is a topic of rules such as `lights_at_night` or `fog_lamps`: ",
        ),
        (["lihgts"], "did you mean the topic `lights`?"),
        # Nearer than the word `bus_lane`.
        (["bus_leavin"], "did you mean the rule `bus_leaving`?"),
        ([], "give a code or a word, such as `R0104` or `gap`, or --all"),
        (["R0101", "--all"], "give a code or a word, such as `R0104` or `gap`, or --all"),
    ],
)
def test_what_cannot_be_answered(arguments, words, capsys):
    status, out, err = explain(capsys, *arguments)
    assert (status, out) == (2, "")
    assert words in err


def test_a_word_of_a_vocabulary(capsys):
    status, out, err = explain(capsys, "gap")
    assert (status, err) == (0, "")
    assert out.startswith(
        "gap: a word of the vocabulary `road`\n"
        "\n"
        "    quantity gap(o: road_user) in m default 1000\n"
        "\n"
        "The distance along the road between ego and o.\n"
        "\n"
        "Supplied by the scene: ego's own motion, and what is measured of others.\n"
        "\n"
        "Recordings of every format can provide it.\n"
        "\n"
    )
    *_, readers = out.split("\n\n")
    assert re.match(r"\d+ rules in the texts of \d+ rulebooks read it", " ".join(readers.split()))


def test_the_rules_that_read_a_word(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("words.rules").write_text("vocabulary words\nzig is one of zag, zog\nsignal zug\n")
    Path("old.rules").write_text(
        "rulebook old\nuse words\n"
        "define fast = zug or zig is zog\n"
        "hard rule A { require never fast accept { not zug } reject { zug } }\n"
        'hard rule B { says "No zug." require never zig is zag }  # zug\n'
    )
    Path("new.rules").write_text(
        "rulebook new\nextends old\nredefine fast = zug\n"
        "define faster = fast\noverride rule B { require never faster }\n"
        'override rule A { cite "1" }\n'
    )
    found = {}
    for word in ("zug", "zig", "zag"):
        assert main(["explain", word, "--json"]) == 0
        (data,) = json.loads(capsys.readouterr().out)
        found[word] = data["read_by"]
    assert found == {
        "zug": {"new": ["B"], "old": ["A"]},
        "zig": {"old": ["A", "B"]},
        "zag": {"old": ["B"]},
    }
    assert main(["explain", "zig"]) == 0
    assert capsys.readouterr().out.endswith(
        "\n\n2 rules in the texts of 1 rulebook read it, also by definitions: A, B.\n"
    )


@pytest.mark.parametrize("word", ["gap", "speed", "built_up", "lane_change", "stopped"])
def test_who_reads_a_word_is_found_in_texts_as_in_formulas(word):
    """The treaty inherits definitions but no rules, so all of its rules are in its own text."""
    names = {rule.name for rule in load_rulebook("vienna").rules if word in names_in(rule.formula)}
    assert names
    assert {*rules_reading([word])["vienna"]} == names


@pytest.mark.parametrize(
    ("word", "says"),
    [
        (
            "beside",
            ["    station(o: road_user) is one of behind, beside, in_front_of\n", "is one of its"],
        ),
        ("enters_box", ["vocabulary `road`", "No format of recordings provides it."]),
        ("tunnel", ["Recordings that can provide it: ", "sumo"]),
        ("told_to_go", ["Where no source tells it, its default holds."]),
        ("ego_mass", ["It stays the same as long as a trace goes on."]),
        (
            "tram",
            ["    type tram is rail_vehicle\n", "Every tram is also: rail_vehicle, road_user."],
        ),
        ("vehicle", ["of the vocabulary `paper`", "of the vocabulary `road`"]),
        ("near_lane_is_free", ["a word of the rulebook `schemas`", "    signal near_lane_is_free"]),
    ],
)
def test_words_are_explained(word, says, capsys):
    status, out, err = explain(capsys, word)
    assert (status, err) == (0, "")
    flat = " ".join(out.split())
    assert [part for part in says if part not in out and part not in flat] == []


def test_a_word_of_ones_own(tmp_path, monkeypatch, capsys):
    (tmp_path / "rulec.toml").write_text('search_path = ["."]\n')
    (tmp_path / "yard.rules").write_text("vocabulary yard {\n  signal horn  # It sounds.\n}\n")
    monkeypatch.chdir(tmp_path)
    status, out, _ = explain(capsys, "horn")
    assert status == 0
    assert "vocabulary `yard`\n\n    signal horn\n\nIt sounds.\n" in out
    assert "ecordings" not in out


def test_a_word_in_other_forms(capsys):
    _, out, _ = explain(capsys, "gap", "R0504", "--output-format", "markdown")
    assert out.startswith("# R0504: ")
    assert "# gap: a word of the vocabulary `road`\n\n```rulec\nquantity gap(" in out
    _, out, _ = explain(capsys, "gap", "--json")
    (word,) = json.loads(out)
    assert (word["word"], word["declared_in"]) == ("gap", "vocabulary road")
    assert explain(capsys, "gap", "R0504", "--json")[:2] == (2, "")


def test_a_word_that_is_misspelt(capsys):
    status, out, err = explain(capsys, "besides")
    assert (status, out) == (2, "")
    assert "did you mean the word `beside`?" in err


def test_a_definition_and_a_parameter_of_a_rulebook(capsys):
    status, out, err = explain(capsys, "passes_stopped")
    assert (status, err) == (0, "")
    assert out.startswith("passes_stopped: a definition of the rulebook `schemas`\n\n    define ")
    assert "\n      then in_front_of(o)\n\nS4: the other one has stopped" in out
    assert "schemas/schemas.rules, line " in " ".join(out.split())
    _, out, _ = explain(capsys, "heavy_mass", "passes_stopped", "--json")
    heavy, *_, passes = json.loads(out)
    assert heavy["declaration"].startswith("param heavy_mass : mass = ")
    assert (passes["word"], passes["declared_in"]) == ("passes_stopped", "rulebook schemas")


def test_a_definition_that_is_misspelt(capsys):
    status, _, err = explain(capsys, "pases_stopped")
    assert status == 2
    assert "did you mean `passes_stopped`, which a rulebook defines?" in err


def test_words_beside_the_file_are_found_without_settings(tmp_path, monkeypatch, capsys):
    (tmp_path / "vocabulary").mkdir()
    yard = "vocabulary yard {\n  signal horn  # It sounds.\n}\n"
    (tmp_path / "vocabulary" / "yard.rules").write_text(yard)
    book = "rulebook own\nuse yard\n# Loud.\ndefine loud = horn\nparam quiet : speed = 5 km/h\n"
    (tmp_path / "own.rules").write_text(book)
    (tmp_path / "broken.rules").write_text("vocabulary broken {\n  signal horn")
    monkeypatch.chdir(tmp_path)
    status, out, _ = explain(capsys, "horn", "loud", "quiet")
    assert status == 0
    assert "horn: a word of the vocabulary `yard`\n" in out
    assert "    define loud = horn\n\nLoud.\n\nIt stands in own.rules, line 4.\n" in out
    assert "quiet: a parameter of the rulebook `own`\n" in out


def test_a_topic_of_ones_own(tmp_path, monkeypatch, capsys):
    (tmp_path / "rulec.toml").write_text('search_path = ["."]\n')
    (tmp_path / "yard.rules").write_text(
        'rulebook yard\nsignal p\ntopics {\n  forklifts "Forklifts" of horn, brake;\n'
        '  ramps "Ramps"\n}\nhard rule horn { require never p }\n'
    )
    monkeypatch.chdir(tmp_path)
    assert "it is a topic of rules such as `horn` or `brake`: " in explain(capsys, "forklifts")[2]
    assert "it is a topic: `rulec list rules --topic ramps`" in explain(capsys, "ramps")[2]
