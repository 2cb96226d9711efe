"""One compiled file for all steps: each trace is judged by its own, without a compiler."""

import json
import multiprocessing
import pickle
from dataclasses import replace
from fractions import Fraction

import pytest

import rulec
from rulec.automata import compiler
from rulec.automata.bundle.bundle_file import from_json, read_compiled, to_json
from rulec.automata.clocks.clocked_machine import TimedMachine
from rulec.automata.tables import SizeError
from rulec.cli.main import main
from rulec.diagnostics import RulecError
from support.builders.compiled_files import sealed

SOURCE = """\
rulebook soon
signal p, q
hard rule soon { require always (p implies eventually[<= 1 s] q) }
hard rule apart { require always not (p and q) }
soft rule before { require always (q implies once[<= 1 s] p) }
"""
UNTOLD = SOURCE + "hard rule some_time { require eventually (p and eventually[<= 1 s] q) }\n"
"""Its last rule is told by no clock."""

STEPS = (Fraction(1, 2), Fraction(1, 3), Fraction(2), Fraction(7, 10))

pytestmark = pytest.mark.usefixtures("compiled_anew")


@pytest.fixture(scope="module", params=["stutter", "finite"])
def soon(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("rules") / "soon.rules"
    path.write_text(SOURCE.replace("signal", f"semantics {request.param}\nsignal", 1))
    return path


@pytest.fixture(scope="module")
def folder(soon, tmp_path_factory):
    path = tmp_path_factory.mktemp("build")
    rulec.write_compiled(rulec.compile_rulebook(soon, step_s=0.5), path)
    return path


@pytest.fixture
def no_compiler(monkeypatch):
    def refused(*_):
        raise AssertionError("a compiler is asked")

    monkeypatch.setattr(compiler, "_worker", refused)


def waiting(states, step_s, **more):
    """``p`` at first, and ``q`` in the last of so many states."""
    truths = [{"p": n == 0, "q": n == states - 1} for n in range(states)]
    return rulec.Trace(f"{states} of {step_s} s", step_s, {}, tuple(truths), **more)


@pytest.mark.usefixtures("no_compiler")
@pytest.mark.parametrize("ends", ["complete", "cut"])
def test_each_trace_is_judged_by_its_own_step(folder, ends):
    rules = read_compiled(folder / "soon.json")
    # A second is two states of the one step, three of the other, and of 0.7 s one.
    for step_s, states in ((0.5, 3), (1 / 3, 4), (0.7, 2), (0.01, 101)):
        in_time = rulec.verify(waiting(states, step_s, ends=ends), rules)
        assert "soon" not in {one.rule for one in in_time.violations}
        late = rulec.verify(waiting(states + 1, step_s, ends=ends), rules)
        assert [one.rule for one in late.violations] == ["soon", "before"]


def test_at_each_step_it_is_what_the_source_is_compiled_to(soon, folder):
    read, source = read_compiled(folder / "soon.json"), rulec.compile_rulebook(soon)
    for step in STEPS:
        ours, theirs = read.at_step(step), source.at_step(step)
        assert ours == theirs == ours.at_step(step)
        for one, other in zip(
            ours.prefixes(ours).values(), theirs.prefixes(theirs).values(), strict=True
        ):
            assert (one.letters, one.starts) == (other.letters, other.starts)
            assert [*map(tuple, one.successors)] == [*map(tuple, other.successors)]
            assert [*map(tuple, one.outputs)] == [*map(tuple, other.outputs)]
    machines = [read.at_step(step).rules[0].machine for step in STEPS]
    assert len({*machines}) == len(STEPS)


def test_the_file_is_read_back_as_it_was(folder):
    text = (folder / "soon.json").read_text()
    data = json.loads(text)
    assert data["version"] == 7
    assert [(rule["name"], rule["step_s"]) for rule in data["rules"]] == [
        ("soon", "1/2"),
        ("apart", None),
        ("before", "1/2"),
    ]
    (clock,) = data["rules"][2]["clocked"]["clocks"]
    assert (clock["from"], clock["to"], clock["unit"]) == ("0", "1", "s")
    assert to_json(from_json(text.encode(), "soon.json")) == text


def test_the_clocked_machine_is_as_large_for_any_bound(tmp_path):
    """The automaton that is unrolled has (k + 1)^2 + 1 states, of which the file says nothing."""
    sizes = []
    for k in (1, 10, 1000):
        path = tmp_path / "both.rules"
        formula = f"always (s implies once[<= {k} s] p and once[<= {k} s] q)"
        path.write_text(f"rulebook both\nsignal p, q, s\nhard rule r {{ require {formula} }}\n")
        rules = rulec.compile_rulebook(path, step_s=k)
        timed = rules.rules[0].timed
        sizes.append((len(timed.clocked.table.successors), len(timed.bounds)))
    assert sizes == [(2, 2)] * 3


@pytest.mark.spot
def test_an_automaton_with_clocks_is_the_same_for_any_bound(tmp_path):
    """A header, whose capital letter forbids tools to ignore it, has what clocks are."""
    bodies = set()
    for k in (1, 10, 1000):
        path = tmp_path / "both.rules"
        formula = f"always (s implies once[<= {k} s] p and once[<= {k} s] q)"
        text = f"rulebook both\nsignal p, q, s\nhard rule r {{ require {formula} }}\n"
        path.write_text(f"{text}hard rule plain {{ require always (s implies p) }}\n")
        rules = rulec.compile_rulebook(path, step_s=k)
        rulec.write_compiled(rules, tmp_path, clocks=True, certificate=False)
        hoa = (tmp_path / "r.hoa").read_text()
        clocks = [line for line in hoa.splitlines() if line.startswith("Rulec-Clock: ")]
        assert clocks == [
            f'Rulec-Clock: "register {n}" "true" "{name}" "0" "{k}" s'
            for n, name in enumerate("pq")
        ]
        bodies.add(hoa.partition("--BODY--")[2])
        with pytest.raises(SyntaxError, match="should not be ignored"):
            pytest.importorskip("spot").automaton(hoa)
        assert "Rulec-Clock" not in (tmp_path / "plain.hoa").read_text()
        # In the compiled rulebook the automata are those of its step, which can be proved.
        assert not any(proof.because for proof in rulec.verify_compiled(tmp_path / "both.json"))
    assert len(bodies) == 1


@pytest.mark.spot
def test_rules_whose_automata_have_no_clocks_are_named(tmp_path, capsys):
    path = tmp_path / "soon.rules"
    path.write_text(UNTOLD)
    assert main(["compile", str(path), "--step", "1", "-o", str(tmp_path), "--clocks"]) == 0
    assert "without clocks: `some_time` (" in capsys.readouterr().err
    assert "Rulec-Clock" not in (tmp_path / "some_time.hoa").read_text()
    assert "Rulec-Clock" in (tmp_path / "soon.hoa").read_text()


def test_a_rule_that_no_clock_tells_is_for_its_step_alone(tmp_path, capsys):
    (tmp_path / "soon.rules").write_text(UNTOLD)
    compiled = rulec.compile_rulebook(tmp_path / "soon.rules", step_s=0.5)
    rulec.write_compiled(compiled, tmp_path)
    lines = [{"step_s": step, "states": [{"p": True, "q": True}]} for step in (0.5, 0.7)]
    traces = tmp_path / "traces.jsonl"
    traces.write_text("".join(f"{json.dumps(line)}\n" for line in lines))
    assert main(["verify", str(traces), "-r", str(tmp_path / "soon.json")]) == 2
    shown = capsys.readouterr()
    assert f"{traces}:2" in shown.err
    assert "error[R0507]" in shown.err
    assert "rule `some_time` was compiled for steps of 0.5 s" in shown.err


def test_what_is_too_large_for_a_step_is_not_judged(folder, monkeypatch):
    rules = read_compiled(folder / "soon.json")

    def too_large(*_):
        raise SizeError

    monkeypatch.setattr(TimedMachine, "at", too_large)
    judgeable = rules.judgeable_at(Fraction(1, 5))
    assert [one.name for one in judgeable.rules] == ["apart"]
    assert [one.name for one in judgeable.too_large] == ["soon", "before"]
    with pytest.raises(RulecError) as refused:
        rules.at_step(Fraction(1, 5))
    assert [one.code for one in refused.value.diagnostics] == ["R0401", "R0401"]


def test_a_bound_of_very_many_steps_is_too_large(folder):
    with pytest.raises(RulecError, match="R0401"):
        read_compiled(folder / "soon.json").at_step(Fraction(1, 10**6))


def test_a_clock_that_begins_far_beyond_its_end_takes_no_memory(soon):
    timed = rulec.compile_rulebook(soon, step_s=0.5).rules[2].timed
    far = replace(timed.bounds[0], low=Fraction(10**13))
    with pytest.raises(SizeError):
        replace(timed, bounds=(far, *timed.bounds[1:])).at(Fraction(1, 3))


def _without_clock(clocked):
    del clocked["clocks"][0]


def _in_no_group(clocked):
    clocked["groups"][0] = -2


def _of_other_letters(clocked):
    clocked["groups"].append(0)


def _negative(clocked):
    clocked["clocks"][0]["from"] = "-1"


def _ends_before_now(clocked):
    clocked["clocks"][0]["to"] = "-1"


def _no_operand(clocked):
    clocked["clocks"][0]["operands"][0] = 4


def _nowhere(clocked):
    clocked["following"][0][0] = 99


def _not_dead(clocked):
    clocked["dead"] = 0


@pytest.mark.parametrize(
    "damage",
    [
        _without_clock,
        _in_no_group,
        _of_other_letters,
        _negative,
        _ends_before_now,
        _no_operand,
        _nowhere,
        _not_dead,
    ],
)
@pytest.mark.parametrize("part", ["own", "alone"])
def test_clocks_that_do_not_fit_are_damage(folder, damage, part):
    data = json.loads((folder / "soon.json").read_text())
    rule = data["rules"][2]
    if data["semantics"] == "finite":
        part = "own"  # It needs no other
    damage(rule["clocked"] if part == "own" else rule["cut_clocked"]["alone"])
    with pytest.raises(RulecError) as problem:
        from_json(sealed(data), "soon.json")
    assert [one.code for one in problem.value.diagnostics] == ["R0404"]


@pytest.mark.parametrize("part", ["alone", "continuing"])
def test_machines_for_cut_traces_that_are_lacking_are_damage(folder, part):
    data = json.loads((folder / "soon.json").read_text())
    cut = data["rules"][2]["cut_clocked"]
    if part not in cut:
        part = "continuing"  # Nothing follows a finite word
    del cut[part]
    with pytest.raises(RulecError) as problem:
        from_json(sealed(data), "soon.json")
    assert [one.code for one in problem.value.diagnostics] == ["R0404"]


def _judged(rules):
    return rulec.verify(waiting(4, 0.5), rules).satisfied, rules.at_step(0.5).prefixes is not None


def test_other_processes_take_compiled_rulebooks(folder):
    rules = read_compiled(folder / "soon.json")
    again = pickle.loads(pickle.dumps(rules))
    assert again == rules
    assert again.at_step(STEPS[1]) == rules.at_step(STEPS[1])
    # Spawned processes share nothing with this one.
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map(_judged, [rules]) == [(False, True)]
