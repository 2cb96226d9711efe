"""One compiled file for several steps: each trace is judged by its own, others are not judged."""

import json
import multiprocessing
import pickle
from fractions import Fraction

import pytest

import rulec
from rulec.automata.bundle.bundle_file import from_json, read_compiled, to_json, write_compiled
from rulec.automata.second_compiler import with_automata
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
STEPS = (Fraction(1, 2), Fraction(1, 3))

pytestmark = pytest.mark.usefixtures("compiled_anew")


@pytest.fixture(scope="module")
def soon(tmp_path_factory):
    path = tmp_path_factory.mktemp("rules") / "soon.rules"
    path.write_text(SOURCE)
    return path


@pytest.fixture(scope="module")
def compiled(soon):
    return with_automata(rulec.compile_rulebook(soon, step_s=STEPS))


@pytest.fixture(scope="module")
def folder(compiled, tmp_path_factory):
    path = tmp_path_factory.mktemp("build")
    write_compiled(compiled, path)
    return path


def waiting(states, step_s, **more):
    """``p`` at first, and ``q`` in the last of so many states."""
    truths = [{"p": n == 0, "q": n == states - 1} for n in range(states)]
    return rulec.Trace(f"{states} of {step_s} s", step_s, {}, tuple(truths), **more)


def test_each_trace_is_judged_by_its_own_step(folder):
    rules = read_compiled(folder / "soon.json")
    # A second is two states of the one step, and three of the other.
    assert rulec.verify(waiting(3, 0.5), rules).satisfied
    assert not rulec.verify(waiting(4, 0.5), rules).satisfied
    assert rulec.verify(waiting(4, 1 / 3), rules).satisfied
    assert not rulec.verify(waiting(5, 1 / 3), rules).satisfied


@pytest.mark.parametrize("more", [{}, {"ends": "cut"}])
def test_a_trace_of_another_step_does_not_stop_the_others(folder, more):
    rules = read_compiled(folder / "soon.json")
    steps = (0.5, 0.25, 1 / 3)
    answers = list(rulec.verify_many([waiting(3, step, **more) for step in steps], rules))
    assert [isinstance(answer, rulec.NotJudged) for answer in answers] == [False, True, False]
    (problem,) = answers[1].error.diagnostics
    assert problem.code == "R0507"
    assert "compiled for steps of 0.5 s and 1/3 s" in problem.message
    assert "0.25 s" in problem.message
    assert "step_s=0.25" in problem.help


def test_it_says_where_the_trace_of_another_step_is(folder, tmp_path, capsys):
    path = tmp_path / "traces.jsonl"
    lines = [{"step_s": step, "states": [{"p": False, "q": False}]} for step in (0.5, 0.7)]
    path.write_text("".join(f"{json.dumps(line)}\n" for line in lines))
    assert main(["verify", str(path), "-r", str(folder / "soon.json")]) == 2
    shown = capsys.readouterr()
    assert f"{path}:2" in shown.err
    assert "error[R0507]" in shown.err
    assert "1 satisfied" in shown.out


def test_the_file_is_read_back_as_it_was(compiled, folder):
    text = (folder / "soon.json").read_text()
    data = json.loads(text)
    assert (data["version"], data["steps"]) == (6, ["1/2", "1/3"])
    assert [(rule["name"], rule["step_s"]) for rule in data["rules"]] == [
        ("soon", "1/2"),
        ("soon", "1/3"),
        ("apart", None),
        ("before", "1/2"),
        ("before", "1/3"),
    ]
    read = from_json(text.encode(), "soon.json")
    assert to_json(read) == text
    for step in STEPS:
        assert read.at_step(step) == compiled.at_step(step) == read.at_step(step).at_step(step)
        cut, fresh = (book.prefixes(book) for book in (read.at_step(step), compiled.at_step(step)))
        assert {name: machine.letters for name, machine in cut.items()} == {
            name: machine.letters for name, machine in fresh.items()
        }
    assert read.at_step(STEPS[0]).rules[0].machine != read.at_step(STEPS[1]).rules[0].machine


def test_each_automaton_has_its_file(folder):
    assert sorted(path.name for path in folder.iterdir()) == [
        "apart.hoa",
        "before-0.5s.hoa",
        "before-1_3s.hoa",
        "soon-0.5s.hoa",
        "soon-1_3s.hoa",
        "soon.json",
    ]


def test_one_step_of_one_is_as_without_others(soon):
    one, alone = (rulec.compile_rulebook(soon, step_s=step) for step in ([0.5], 0.5))
    assert to_json(one) == to_json(alone)
    assert to_json(rulec.compile_rulebook(soon, step_s=[0.5, 0.5])) == to_json(alone)
    with pytest.raises(ValueError, match="has no step"):
        rulec.compile_rulebook(soon, step_s=[])


def test_of_several_steps_some_can_be_taken(folder, soon):
    path = folder / "soon.json"
    assert rulec.compile_rulebook(path, step_s=0.5) == rulec.compile_rulebook(soon, step_s=0.5)
    with pytest.raises(RulecError) as problem:
        rulec.compile_rulebook(path, step_s=[0.5, 0.25])
    assert [one.code for one in problem.value.diagnostics] == ["R0507"]


def _without_first(rules):
    del rules[0]


def _doubled(rules):
    rules.append(rules[0])


def _of_no_step(rules):
    rules[0]["step_s"] = "1"


def _softer(rules):
    rules[0]["strength"] = "soft"


@pytest.mark.parametrize("damage", [_without_first, _doubled, _of_no_step, _softer])
def test_steps_that_do_not_fit_together_are_damage(folder, damage):
    data = json.loads((folder / "soon.json").read_text())
    damage(data["rules"])
    with pytest.raises(RulecError) as problem:
        from_json(sealed(data), "soon.json")
    assert [one.code for one in problem.value.diagnostics] == ["R0404"]


@pytest.mark.parametrize("change", [{"steps": []}, {"steps": ["1/2", "1/2"]}])
def test_steps_that_are_none_are_damage(folder, change):
    data = json.loads((folder / "soon.json").read_text())
    with pytest.raises(RulecError) as problem:
        from_json(sealed({**data, **change}), "soon.json")
    assert [one.code for one in problem.value.diagnostics] == ["R0404"]


def test_a_recording_of_another_step_has_all_its_drives_not_judged(folder, tmp_path, capsys):
    recording = tmp_path / "fcd.xml"
    recording.write_text(_FCD)
    (tmp_path / "net.net.xml").write_text(_NET)
    arguments = ["--map", str(tmp_path / "net.net.xml"), "-r", str(folder / "soon.json")]
    assert main(["verify", str(recording), *arguments]) == 2
    shown = capsys.readouterr()
    assert "not judged: v: rule `soon` was compiled for steps of" in shown.out
    assert "error[R0507]" in shown.err
    assert "0.5 s and 1/3 s" in shown.err


_NET = """\
<net version="1.20"><location netOffset="0,0" convBoundary="0,0,100,0" projParameter="!"/>
<edge id="a" from="x" to="y" priority="1"><lane id="a_0" index="0" speed="13.9" length="100"
 shape="0,0 100,0"/></edge></net>
"""
_FCD = "<fcd-export>{}</fcd-export>".format(
    "".join(
        f'<timestep time="{n}.00"><vehicle id="v" x="{10 + 5 * n}" y="0" angle="90" type="car"'
        f' speed="5" pos="{10 + 5 * n}" lane="a_0" slope="0"/></timestep>'
        for n in range(4)
    )
)


def _judged(rules):
    return rulec.verify(waiting(4, 0.5), rules).satisfied, rules.at_step(0.5).prefixes is not None


def test_other_processes_take_compiled_rulebooks(compiled, folder):
    both = [compiled, read_compiled(folder / "soon.json")]
    for rules in both:
        again = pickle.loads(pickle.dumps(rules))
        assert again == rules
        assert again.at_step(STEPS[1]) == rules.at_step(STEPS[1])
    # Spawned processes share nothing with this one.
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map(_judged, both) == [(False, True)] * 2
