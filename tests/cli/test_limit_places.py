"""Whatever is beyond a limit that can be lifted is shown where it stands."""

import json
from pathlib import Path

import pytest

from rulec.automata import compiler
from rulec.cli.main import main
from rulec.recordings.doubts import crowds
from rulec.resource_limits import LIMITS
from support import remembered_machines

BOOK = """rulebook small
type car
type bus is car
signal near(a: car, b: car) default false
signal p, q, r default false
hard rule gap (a: car, b: car) {
  cite "Article 1"
  require always not near(a, b)
}
hard rule soon { require always (p implies eventually[<= 1 s] q) }
hard rule odd { require always (p xor q xor r) }
"""
TRACES = "\n".join(
    json.dumps({"step_s": step, "objects": {"a": "car", "b": "car"}, "states": [{}, {}]})
    for step in (1, 0.5, 0.25)
)
OWN = "rulebook own\nsignal p, q default false\n" + "".join(
    f"hard rule r{n} {{ require always (p implies eventually[<= {n} s] q) }}\n"
    for n in (31, 32, 33)
)
FILES = {
    "small.rules": BOOK,
    "like.rules": BOOK.replace("rulebook small", "rulebook like"),
    "own.rules": OWN,
    "t.jsonl": TRACES,
    "refused.jsonl": "{}\n" * 3,
    "law.md": "# Act\n\n## Article 1\n\nDrive.\n",
}
FOLLOWING = str(Path(__file__).parents[2] / "docs/samples/following.xml")
OF_THE_CALL = {"memory", "seconds"}
"""Limits of a whole call, which has no place: ``test_enforced_limits``."""

OF_A_RULE = "small.rules:6"
ASKED = {
    "choices": (0, ["verify", "t.jsonl", "-r", "./small.rules"], "t.jsonl:1"),
    "steps": (1, ["verify", "t.jsonl", "-r", "./small.rules"], "t.jsonl:3"),
    "states": (1, ["verify", "t.jsonl", "-r", "./small.rules"], "t.jsonl:1"),
    "refused": (1, ["verify", "refused.jsonl", "-r", "./small.rules"], "refused.jsonl:2"),
    "compiling": (0, ["compile", "own.rules", "--step", "1", "-o", "out"], "own.rules:"),
    "objects": (1, ["verify", "t.jsonl", "-r", "./small.rules"], "t.jsonl:1"),
    "places": (3, ["maneuvers", "s1", "-r", "esterle2019"], "s1"),
    "cubes": (1, ["show", "./small.rules", "odd"], "small.rules:11"),
    "comparisons": (0, ["diff", "--all", "./small.rules", "./like.rules"], OF_A_RULE),
    "pairs": (0, ["analyze", "./small.rules"], OF_A_RULE),
    "type_depth": (1, ["check", "./small.rules"], "small.rules:3"),
    "cites": (0, ["show", "--audit", "./small.rules", "--law", "law.md"], OF_A_RULE),
    "lookback": (
        1,
        ["find", "once[<= 10 s] p", "t.jsonl", "-r", "./small.rules"],
        "t.jsonl:1",
    ),
    "crowd": (0, ["verify", FOLLOWING, "-r", "de"], FOLLOWING),
    "search": (0, ["analyze", "./small.rules"], "small.rules:"),
}


def test_each_limit_is_asked_for():
    assert ASKED.keys() | OF_THE_CALL == LIMITS.keys()


@pytest.mark.parametrize("limit", ASKED)
def test_the_place_is_told(limit, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    if limit == "compiling":  # what is remembered takes no time
        monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "cache"))
        monkeypatch.setattr(compiler, "answers_to", remembered_machines.ASKED)
    if limit == "crowd":  # pairs of few participants are never counted
        monkeypatch.setattr(crowds, "_FEW_PAIRS", 0)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    number, words, place = ASKED[limit]
    main(["--limit", f"{limit}={number}", *words])
    said = capsys.readouterr()
    told = said.out + said.err
    code = "R0807" if limit == "search" else "R0718"
    (first, *_) = [part for part in told.split("\n\n") if code in part] or [told]
    at = [line.split("--> ")[1] for line in first.splitlines() if "--> " in line]
    assert code in first, told
    assert any(one.startswith(place) for one in at), told
    assert f"--limit {limit}=" in told


def test_too_many_comparisons_are_told_at_a_rule_of_the_author(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = "use road\nhard rule bus_leaving (b: bus) { require never leaving_stop(b) }\n"
    (tmp_path / "own.rules").write_text(f"rulebook own\n{words}")
    # More of the others have other rules, whose places are in files that ship with rulec.
    main(["--limit", "comparisons=1", "diff", "--all", "de", "nl", "fr", "./own.rules"])
    said = capsys.readouterr().err
    assert "--> own.rules:3:1" in said
    assert "3 rulebooks, 3 of which have `bus_leaving`: " in said
