"""Steps on the command line: `compile --step`, and compiled rulebooks that know one step."""

import json
from fractions import Fraction

import pytest

from rulec.automata.bundle.bundle_file import read_compiled, to_json
from rulec.automata.compiler import compile_rulebook
from rulec.cli.main import main
from rulec.logic.formula import Bound, Unary, UnaryOperator
from support.builders.rulebooks import P, Q, always, book, implies, rule

SOON = Unary(UnaryOperator.EVENTUALLY, Q, Bound(Fraction(0), Fraction(1), "s"))


@pytest.fixture
def compiled(tmp_path):
    """A rulebook that was compiled for steps of 0.5 s."""
    rules = compile_rulebook(book(rule("A", always(implies(P, SOON)))), step_s=Fraction(1, 2))
    path = tmp_path / "book.json"
    path.write_text(to_json(rules))
    return path


@pytest.mark.parametrize(
    "step", ["0", "0.0", "-1", "1/0", "0/3", "nan", "1e5", "x", "", "1/-3", "9" * 99]
)
def test_what_is_no_step(step, tmp_path, capsys):
    assert main(["compile", "esterle2019", "-o", str(tmp_path / "out"), f"--step={step}"]) == 2
    assert (
        "a number above 0, in seconds, without a unit and without an exponent"
        in capsys.readouterr().err
    )
    assert not (tmp_path / "out").exists()


def test_steps_of_a_jittering_clock_are_taken_for_one_where_that_is_asked_for(
    compiled, tmp_path, capsys
):
    traces = tmp_path / "t.jsonl"
    lines = [
        json.dumps({"id": name, "step_s": step, "states": [{"p": True, "q": True}]})
        for name, step in (("even", 0.5), ("odd", 0.5001), ("other", 0.6))
    ]
    traces.write_text("\n".join(lines))
    judge = ["verify", str(traces), "-r", str(compiled), "--json"]
    assert main(judge) == 2
    assert capsys.readouterr().err.count("R0507") == 2
    assert main([*judge, "--step", "0.5"]) == 2
    said = capsys.readouterr()
    assert (said.err.count("R0507"), said.err.count("R0724")) == (0, 1)
    verdicts = [json.loads(line) for line in said.out.splitlines()]
    assert [one["trace"] for one in verdicts if one.get("satisfied")] == ["even", "odd"]


@pytest.mark.parametrize("step", ["1", "0.25", "1/3"])
def test_a_step_makes_no_difference_to_rules_without_seconds(step, tmp_path, capsys):
    assert main(["compile", "esterle2019", "-o", str(tmp_path), f"--step={step}"]) == 0
    rules = read_compiled(tmp_path / "esterle2019.json").rules
    assert [one.step_s for one in rules] == [None] * 3


def test_traces_of_another_step_are_not_judged_and_do_not_stop_the_others(
    compiled, tmp_path, capsys
):
    traces = tmp_path / "t.jsonl"
    states = [{"p": True, "q": False}, {"q": False}, {"q": True}]
    lines = [json.dumps({"id": f"{step}", "step_s": step, "states": states}) for step in (1, 0.5)]
    traces.write_text("\n".join(lines))
    assert main(["verify", str(traces), "-r", str(compiled), "--json"]) == 2
    captured = capsys.readouterr()
    first, second = map(json.loads, captured.out.splitlines())
    assert first["error"]["code"] == "R0507"
    assert second["satisfied"]
    assert "compile its source with `--step 1`" in captured.err


def test_a_compiled_rulebook_is_not_compiled_for_another_step(compiled, tmp_path, capsys):
    arguments = ["compile", str(compiled), "-o", str(tmp_path / "out"), "--step"]
    assert main([*arguments, "1"]) == 2
    assert "error[R0507]" in capsys.readouterr().err
    assert main([*arguments, "0.5"]) == 0
