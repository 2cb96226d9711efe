"""``rulec verify`` as its user meets it."""

import json

import pytest

from rulec import compile_rulebook
from rulec.cli.main import main
from rulec.monitoring.rulebook_edition import rulebook_hash

OBJECTS = {"v1": "vehicle"}


def line(name, positions, **more):
    states = [{"position": {"v1": p}, "surface": "R_cw", "CONGESTED": False} for p in positions]
    return json.dumps({"id": name, "step_s": 1.0, "objects": OBJECTS, "states": states, **more})


@pytest.fixture
def verify(tmp_path, capsys):
    """Run `rulec verify --rulebook esterle2019` on files of the given lines."""

    def run(*files, options=()):
        paths = []
        for number, lines in enumerate(files):
            path = tmp_path / f"{number}.jsonl"
            path.write_text("\n".join(lines))
            paths.append(str(path))
        status = main(["verify", *paths, "--rulebook", "esterle2019", *options])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


VIENNA = "Convention on Road Traffic, done at Vienna on 8 November 1968"
LAW = {
    "law": VIENNA,
    "as_of": "1968-11-08",
    "at": "1968-11-08",
    "rulebook_hash": rulebook_hash(compile_rulebook("esterle2019")),
}


def test_the_documented_line_of_json(verify):
    status, out, err = verify([line("t1", "brrf")], options=["--json"])
    assert (status, err) == (1, "")
    assert json.loads(out) == {
        "version": 1,
        "trace": "t1",
        "rulebook": "esterle2019",
        "law": LAW,
        "satisfied": False,
        "violations": [
            {
                "rule": "R1",
                "binding": {"v": "v1"},
                "step": 3,
                "strength": "hard",
                "level": None,
                "weight": 1,
            }
        ],
        "judged": ["R1", "R2", "R3"],
        "open": [],
        "not_judged": [],
        "kept_regardless": [],
        "presumed": [],
    }


def test_satisfied(verify):
    status, out, err = verify([line("t1", "bblf")], options=["--json"])
    assert (status, err) == (0, "")
    assert json.loads(out) == {
        "version": 1,
        "trace": "t1",
        "rulebook": "esterle2019",
        "law": LAW,
        "satisfied": True,
        "violations": [],
        "judged": ["R1", "R2", "R3"],
        "open": [],
        "not_judged": [],
        "kept_regardless": [],
        "presumed": [],
    }


def test_text(verify):
    status, out, err = verify([line("t1", "brrf"), line("t2", "bblf")], options=["--explain", "0"])
    assert (status, err) == (1, "")
    head, found, rest = out.partition("t1: violated\n")
    law = f"by esterle2019: {VIENNA} as of 1968-11-08 [{LAW['rulebook_hash'][:8]}]"
    assert " ".join(head.split()) == law
    assert found + rest == (
        "t1: violated\n"
        "  hard rule R1 [Article 11.1, 11.6] for v = v1: cannot be kept any more after\n"
        "      state 3\n"
        "2 traces: 1 satisfied, 1 violated\n"
    )


def test_the_first_violations_are_explained(verify):
    bad = [line("t1", "brrf"), line("t2", "brrf"), line("t3", "brrf")]
    _, out, _ = verify(bad)
    assert out.count("position(v1)") == 1
    _, out, _ = verify(bad, options=["--explain", "2"])
    assert out.count("position(v1)") == 2
    rows = [row.split() for row in out.splitlines()]
    assert ["position(v1)", "b", "r", "r", "f*"] in rows
    assert ["state", "0", "1", "2", "3"] in rows
    # Until is true one state before what it waits for, and the whole is lost from the start.
    assert ["r(v)", "until", "f(v)", "F", "T", "T", "T"] in rows


def test_a_long_formula_is_folded_unless_all_of_it_is_wanted(tmp_path, capsys):
    """Two of fourteen signals are true and lose the rule; the first of them decides.

    The parts about one state are left to the facts.
    """
    names = [f"a_signal_with_a_long_name_{n}" for n in range(14)]
    book, traces = tmp_path / "long.rules", tmp_path / "t.jsonl"
    book.write_text(
        f"rulebook long\nsignal {', '.join(names)} default false\n"
        f"hard rule r {{ require never ({' or '.join(names)}) }}\n"
    )
    traces.write_text(json.dumps({"states": [{}, {names[5]: True, names[9]: True}]}))
    assert main(["verify", str(traces), "-r", str(book)]) == 1
    out = capsys.readouterr().out
    rows = [row.split() for row in out.splitlines()]
    assert rows.count([names[5], "F", "T*"]) == 1
    # 14 facts and 1 + 13 + 14 parts, of which the fact and two parts are left.
    repair, _, table = out.partition("    state ")
    assert names[9] not in table
    assert "    … without 39 of 42 rows: --every-part shows them" in table.splitlines()
    wanted = f"kept if state 1 says: not {names[5]} and not {names[9]}"
    assert wanted in " ".join(repair.split())
    assert max(map(len, out.splitlines())) <= 80
    assert main(["verify", str(traces), "-r", str(book), "--every-part"]) == 1
    out = capsys.readouterr().out
    assert "without" not in out
    assert all(sum(name in row.split() for row in out.splitlines()) >= 2 for name in names)
    assert main(["verify", str(traces), "-r", str(book), "--json", "--explain", "1"]) == 1
    (violation,) = json.loads(capsys.readouterr().out)["violations"]
    parts = violation["explanation"]["parts"]
    assert len(parts) == 28
    # The formula, the chain down to its sixth signal (9 links), and that signal.
    assert sum(part["decides"] for part in parts) == 1 + 9 + 1


def test_explanations_as_data(verify):
    _, out, _ = verify([line("t1", "brrf")], options=["--json", "--explain", "1"])
    (violation,) = json.loads(out)["violations"]
    explanation = violation["explanation"]
    assert explanation["decisive"] == violation["step"] == 3
    assert explanation["states"] == [0, 1, 2, 3]
    assert explanation["cite"] == "Article 11.1, 11.6"
    axioms = {fact["reads"]: fact["values"] for fact in explanation["facts"]}
    assert axioms == {"CONGESTED": [False] * 4, "position(v1)": ["b", "r", "r", "f"]}
    assert explanation["parts"][0]["depth"] == 0
    assert explanation["parts"][0]["values"][0] is False
    assert explanation["repair"] == [{"state": 3, "says": "not f(v)"}]


def test_a_bad_trace_never_hides_the_good_ones(verify):
    lines = [line("t1", "brrf"), '{"id": "t2", "stat', line("t3", "bblx"), line("t4", "bblf")]
    status, out, err = verify(lines, options=["--json"])
    assert status == 2
    t1, t2, t3, t4 = map(json.loads, out.splitlines())
    assert (t1["satisfied"], t4["satisfied"]) == (False, True)
    assert (t2["trace"], t2["error"]["line"], t2["error"]["code"]) == (None, 2, "R0501")
    assert (t3["trace"], t3["error"]["line"], t3["error"]["code"]) == ("t3", 3, "R0503")
    assert "0.jsonl:2" in err
    assert "0.jsonl:3" in err


def test_one_mistake_in_every_trace_is_not_said_every_time(verify):
    status, out, err = verify([line(f"t{n}", "x") for n in range(25)])
    assert status == 2
    assert err.count("error[R0503]") == 10
    assert "… and 15 more of this kind [R0503]" in err
    assert "25 traces: 0 satisfied, 0 violated, 25 not judged" in out


def test_names_cannot_drive_the_terminal(verify):
    _, out, _ = verify([line("t\x1b[31m\x00", "brrf")])
    assert "t\\x1b[31m\\x00: violated" in out


def test_many_violations_of_one_trace(verify):
    objects = {f"v{n}": "vehicle" for n in range(30)}
    states = [{"position": dict.fromkeys(objects, p)} for p in "brf"]
    trace = json.dumps({"id": "t", "objects": objects, "states": states})
    _, out, _ = verify([trace])
    assert out.count("hard rule R1") == 20
    assert "and 10 more" in out
    _, out, _ = verify([trace], options=["--json"])
    assert len(json.loads(out)["violations"]) == 30


def test_a_missing_file_never_hides_the_others(verify, tmp_path):
    status, out, err = verify([line("t4", "bblf")], options=[str(tmp_path / "missing.jsonl")])
    assert status == 2
    assert "2 traces: 1 satisfied, 0 violated, 1 not judged" in out
    assert "the file cannot be read: no such file" in err


def test_an_empty_file_is_not_satisfied(verify):
    status, _, err = verify([])
    assert status == 2
    assert "no trace" in err


def test_several_files(verify):
    status, out, _ = verify([line("t1", "bblf")], [line("t2", "brrf")])
    assert status == 1
    assert "2 traces: 1 satisfied, 1 violated" in out


def test_standard_input(capsys, monkeypatch, tmp_path):
    path = tmp_path / "in"
    path.write_text(line("t1", "brrf"))
    with path.open() as stream:
        monkeypatch.setattr("sys.stdin", stream)
        status = main(["verify", "-", "--rulebook", "esterle2019"])
    assert status == 1
    assert "1 violated" in capsys.readouterr().out


def test_an_unknown_rulebook_names_the_nearest(verify, capsys):
    status = main(["verify", "x.jsonl", "--rulebook", "esterle2091"])
    captured = capsys.readouterr()
    assert status == 2
    assert captured.out == ""
    assert "esterle2019" in captured.err


def test_a_source_and_what_it_compiles_to_judge_alike(tmp_path, capsys):
    traces = tmp_path / "t.jsonl"
    traces.write_text("\n".join(line(f"t{n}", word) for n, word in enumerate(["brrf", "bblf"])))
    source = tmp_path / "mine.rules"
    source.write_text(
        "rulebook mine\nuse paper\nsoft rule gentle (v: vehicle) { require never_right }\n".replace(
            "never_right", "always not r(v)"
        )
    )
    assert main(["compile", str(source), "-o", str(tmp_path / "out")]) == 0
    capsys.readouterr()
    outputs = []
    for rulebook in (source, tmp_path / "out" / "mine.json"):
        status = main(["verify", str(traces), "--json", "--rulebook", str(rulebook)])
        outputs.append((status, capsys.readouterr().out))
    assert outputs[0] == outputs[1]
    status, out = outputs[0]
    first = json.loads(out.splitlines()[0])
    # A soft rule may yield: the trace satisfies the rulebook, and the violation is told.
    assert status == 0
    assert first["satisfied"]
    (violation,) = first["violations"]
    assert (violation["rule"], violation["strength"], violation["step"]) == ("gentle", "soft", 1)


@pytest.mark.parametrize("form", ["csv", "parquet", "jsonl"])
def test_every_format_is_written_and_judged_alike(form, tmp_path, capsys):
    if form == "parquet":
        pytest.importorskip("pyarrow")
    path = tmp_path / f"traces.{form}"
    assert main(["maneuvers", "--traces", "s1", "--step", "0.5", "-o", str(path)]) == 0
    assert capsys.readouterr().out == f"wrote 672 of 672 traces to {path}\n"
    assert main(["verify", str(path), "--rulebook", "esterle2019", "--json"]) == 1
    answers = [json.loads(one) for one in capsys.readouterr().out.splitlines()]
    # Table V of the paper.
    assert (len(answers), sum(one["satisfied"] for one in answers)) == (672, 640)
    other = path.rename(tmp_path / "traces")
    assert main(["verify", str(other), "-r", "esterle2019", "--format", form, "--json"]) == 1
    assert [json.loads(one) for one in capsys.readouterr().out.splitlines()] == answers


def test_csv_in_a_pipe(capsys, monkeypatch, tmp_path):
    path = tmp_path / "in"
    assert main(["maneuvers", "--traces", "s1", "-o", "-", "--format", "csv", "--first", "3"]) == 0
    path.write_text(capsys.readouterr().out)
    with path.open() as stream:
        monkeypatch.setattr("sys.stdin", stream)
        assert main(["verify", "-", "-r", "esterle2019", "--format", "csv"]) == 0
    assert "3 traces: 3 satisfied" in capsys.readouterr().out


def test_a_file_whose_traces_share_an_id_is_judged_with_a_warning(verify):
    again = [line("a", "bb"), line("b", "bb"), line("a", "brrf"), line("a", "bb")]
    status, out, err = verify(again, [line("a", "bb")])
    assert (status, "5 traces: 4 satisfied, 1 violated" in out) == (1, True)
    assert err.count("warning[R0512]") == 1
    assert "0.jsonl:3\n" in err
    assert "warning" not in verify([line("a", "bb"), line("b", "bb")], [line("b", "bb")])[2]


@pytest.mark.parametrize(
    ("state", "hint"),
    [
        ('{"fart": 60}', "words that may mean it: `speed` (ego's speed), `speed_difference`"),
        ('{"light": "red"}', "words that may mean it: `red_light` (ego's light is red)"),
    ],
)
def test_unknown_words_of_a_trace_get_the_suggestions_of_formulas(state, hint, tmp_path, capsys):
    (tmp_path / "t.jsonl").write_text(f'{{"id": "t", "states": [{state}]}}\n')
    assert main(["verify", str(tmp_path / "t.jsonl"), "-r", "de"]) == 2
    assert hint in capsys.readouterr().err


def test_an_assumption_on_an_unknown_word_gets_a_suggestion(tmp_path, capsys):
    (tmp_path / "t.jsonl").write_text('{"id": "t", "states": [{"speed": 60}]}\n')
    assert main(["verify", str(tmp_path / "t.jsonl"), "-r", "de", "--assume", "fart=50"]) == 2
    said = "`de` does not know `fart`; did you mean `speed` (ego's speed)?"
    assert said in capsys.readouterr().err


def test_only_some_rules(verify):
    # R1 forbids it
    options = ["--json", "--rule", "R2", "--rule", "R3"]
    status, out, err = verify([line("t1", "brrf")], options=options)
    assert (status, err) == (0, "")
    assert json.loads(out)["violations"] == []
    status, out, err = verify([line("t1", "brrf")], options=["--json", "--rule", "R[12]"])
    assert (status, err) == (1, "")
    assert [found["rule"] for found in json.loads(out)["violations"]] == ["R1"]


def test_a_pattern_that_no_rule_matches(verify):
    status, out, err = verify([line("t1", "brrf")], options=["--rule", "R1", "--rule", "S1"])
    assert (status, out) == (2, "")
    assert "--rule: esterle2019 has no rule like `S1`" in err


def test_exposure_is_of_all_rules(verify, tmp_path):
    options = ["--rule", "R1", "--exposure", "-o", str(tmp_path / "f.jsonl")]
    status, _, err = verify([line("t1", "brrf")], options=options)
    assert status == 2
    assert "leave out --rule" in err
    assert not (tmp_path / "f.jsonl").exists()
