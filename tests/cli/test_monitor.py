"""``rulec monitor`` as its user, and the program at the other end of its pipes, meet it."""

import json
import signal
import subprocess
import sys

import pytest

from rulec.cli.main import main
from support.builders.terminal_signals import as_from_a_terminal

RULEC = [sys.executable, "-c", "from rulec.cli.entry_point import run; raise SystemExit(run())"]
BOOK = """
rulebook waiting
type car
signal stop_sign, standing default false
signal seen(c: car)
hard rule stop { require always (stop_sign implies eventually standing) }
hard rule look (c: car) { require eventually seen(c) }
"""
SIGN, STAND, NOTHING = (
    json.dumps({"state": state}) for state in ({"stop_sign": True}, {"standing": True}, {})
)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "waiting.rules").write_text(BOOK, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def answer(folder, monkeypatch, capsys):
    def run(lines, *arguments):
        (folder / "lines").write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
        with (folder / "lines").open(encoding="utf-8") as stream:
            monkeypatch.setattr(sys, "stdin", stream)
            status = main(["monitor", "./waiting.rules", *arguments])
        captured = capsys.readouterr()
        return status, captured.out.splitlines(), captured.err

    return run


def test_a_line_for_each_state(answer):
    assert answer([SIGN, NOTHING, STAND]) == (
        0,
        ["0: pending; stop: pending", "1: pending", "2: holds so far; stop: holds so far"],
        "",
    )


def test_what_is_pending_at_the_end_is_violated(answer):
    assert answer([STAND, SIGN])[0] == 1


def test_blank_lines_and_a_mark_at_the_beginning_are_no_states(answer):
    assert answer(["\ufeff" + SIGN, "", "  ", STAND])[1][-1].startswith("1: ")


def test_nothing_to_judge(answer):
    message = "rulec: no state came on standard input: nothing was judged\n"
    assert answer([]) == (2, [], message)
    assert answer([" "]) == (2, [], message)
    answer([SIGN], "--save", "saved.json")
    assert answer([], "--restore", "saved.json") == (1, [], "")


BAD = [
    ("{", "R0501"),
    ("[]", "R0501"),
    ('{"stop_sign": true}', "R0501"),
    ('{"state": {"standing": NaN}}', "R0501"),
    ('{"state": {}, "object": {}}', "R0501"),
    ("[" * 100_000, "R0501"),
    ('{"state": {"stop": true}}', "R0502"),
    ('{"state": {"standing": 1}}', "R0503"),
    ('{"state": {}, "objects": {"c": "car"}}', "R0504"),
    ('{"state": {}, "objects": {"c": "bus"}}', "R0505"),
]


@pytest.mark.parametrize(("line", "code"), BAD)
def test_a_bad_line_is_said_and_changes_nothing(answer, line, code):
    status, out, err = answer([SIGN, line, NOTHING])
    assert (status, out) == (2, ["0: pending; stop: pending", "1: pending"])
    assert f"error[{code}]" in err
    assert "standard input:2" in err


def test_the_way_out(answer):
    assert "did you mean `objects`?" in answer(['{"state": {}, "object": {}}'])[2]
    assert 'a line such as {"state"' in answer(["[]"])[2]


@pytest.mark.parametrize("objects", [{"v1": 5}, ["v1"], None])
def test_types_in_a_way_out_are_of_the_rulebook(answer, folder, objects):
    lines = [json.dumps({"state": {}, "objects": objects})]
    for types, way_out in (
        ("", 'the rulebook has no types of objects: leave out "objects"'),
        ("type obstacle", 'objects have types: write "objects": {"v1": "obstacle"}'),
        ("type obstacle type vehicle is obstacle", '{"v1": "vehicle"}'),
    ):
        book = f"rulebook waiting {types} signal p hard rule r {{ require always p }}"
        (folder / "waiting.rules").write_text(book, encoding="utf-8")
        assert f"{way_out}\n" in answer(lines)[2]
        assert ('"objects"' in answer(["{"])[2]) == bool(types)


def test_json(answer):
    there = json.dumps({"state": {"seen": {"c": False}}, "objects": {"c": "car"}})
    status, out, _ = answer([there, "{", NOTHING], "--json")
    assert status == 2
    first, refused, last = map(json.loads, out)
    assert first == {
        "version": 1,
        "state": 0,
        "verdict": "pending",
        "best": "pending",
        "worst": "pending",
        "rules": {"stop": "holds so far", "look": "pending"},
        "open": {},
        "changes": [
            {
                "rule": "look",
                "binding": {"c": "c"},
                "before": "holds so far",
                "verdict": "pending",
                "best": "pending",
                "worst": "pending",
                "ended": False,
            }
        ],
    }
    assert refused["state"] is None
    assert (refused["error"]["code"], refused["error"]["line"]) == ("R0501", 2)
    assert [(one["before"], one["verdict"], one["ended"]) for one in last["changes"]] == [
        ("pending", "violated", True)
    ]


def test_who_has_left_is_said(answer):
    there = json.dumps({"state": {"seen": {"c": False}}, "objects": {"c": "car"}})
    assert answer([there, NOTHING])[1] == [
        "0: pending; look for c = c: pending",
        "1: violated; look for c = c: violated, not fulfilled when it left",
    ]


def test_only_so_much_fits_on_a_line(answer):
    objects = {f"c{number}": "car" for number in range(30)}
    line = json.dumps({"state": {"seen": dict.fromkeys(objects, False)}, "objects": objects})
    (out,) = answer([line])[1]
    assert (out.count("look for"), out.endswith("; and 10 more")) == (20, True)


def test_saved_and_restored_in_the_same_file(answer, folder):
    assert answer([SIGN], "--save", "m.json")[0] == 0
    assert answer([NOTHING], "--restore", "m.json", "--save", "m.json")[1] == ["1: pending"]
    assert answer([], "--restore", "m.json")[0] == 1
    status, out, _ = answer([STAND], "--restore", "m.json")
    assert (status, out) == (0, ["2: holds so far; stop: holds so far"])
    assert [one.name for one in folder.iterdir() if one.name.startswith(".")] == []


@pytest.mark.parametrize("text", ["", "{}", "[1]", "\udcff".encode("utf-8", "surrogateescape")])
def test_what_is_no_saved_monitor(answer, folder, text):
    data = text if isinstance(text, bytes) else text.encode()
    (folder / "m.json").write_bytes(data)
    status, out, err = answer([SIGN], "--restore", "m.json")
    assert (status, out) == (2, [])
    assert "error[R0510]" in err
    assert "m.json" in err


def test_a_saved_monitor_that_has_been_cut_short(answer, folder):
    assert answer([SIGN], "--save", "m.json")[0] == 0
    whole = (folder / "m.json").read_bytes()
    (folder / "m.json").write_bytes(whole[: len(whole) // 2])
    status, _, err = answer([SIGN], "--restore", "m.json")
    assert status == 2
    assert "this is not a saved monitor: it has been cut short" in err


def test_what_cannot_be_saved_is_said_before_anything_is_judged(answer):
    status, out, err = answer([SIGN], "--save", "nowhere/m.json")
    assert (status, out) == (2, [])
    assert "error[R0702]" in err


def test_a_missing_file(answer):
    assert "error[R0701]" in answer([SIGN], "--restore", "m.json")[2]


def test_the_step_is_that_of_the_saved_monitor_unless_it_is_given(answer, folder):
    (folder / "waiting.rules").write_text(
        "rulebook waiting\nsignal p default false\n"
        "hard rule soon { require always (p implies eventually[<= 1 s] not p) }\n",
        encoding="utf-8",
    )
    p = '{"state": {"p": true}}'
    assert answer([p, p], "--step", "1/2", "--save", "m.json")[1][-1] == "1: pending"
    assert answer([p], "--restore", "m.json")[1] == ["2: violated; soon: violated"]
    assert "error[R0510]" in answer([p], "--step", "1", "--restore", "m.json")[2]


@pytest.fixture
def running(folder):
    process = subprocess.Popen(
        [*RULEC, "monitor", "./waiting.rules", "--save", "m.json"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=folder,
        preexec_fn=as_from_a_terminal,
    )
    with process:
        yield process
        process.kill()


def tell(process, line):
    process.stdin.write(f"{line}\n".encode())
    process.stdin.flush()


def states_in(file):
    return json.loads(file.read_text(encoding="utf-8"))["states"]


def test_every_state_is_answered_before_the_next_one_is_known(running):
    for line, expected in [(SIGN, b"0: pending; stop: pending\n"), (NOTHING, b"1: pending\n")]:
        tell(running, line)
        assert running.stdout.readline() == expected


@pytest.mark.parametrize(
    ("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)]
)
def test_it_saves_whatever_ends_it(running, folder, number, status):
    tell(running, SIGN)
    running.stdout.readline()
    running.send_signal(number)
    assert running.wait(30) == status
    assert states_in(folder / "m.json") == 1
    assert list(folder.glob("*.part")) == []


def test_what_was_saved_stays_until_the_end(folder, running):
    tell(running, SIGN)
    running.stdout.readline()
    running.send_signal(signal.SIGINT)
    running.wait(30)
    again = subprocess.Popen(
        [*RULEC, "monitor", "./waiting.rules", "--save", "m.json"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=folder,
    )
    with again:
        tell(again, SIGN)
        again.stdout.readline()
        tell(again, SIGN)
        again.stdout.readline()
        # As when the power fails
        again.kill()
    assert states_in(folder / "m.json") == 1


def test_it_saves_when_the_reader_leaves(running, folder):
    tell(running, SIGN)
    running.stdout.readline()
    running.stdout.close()
    tell(running, SIGN)
    assert running.wait(30) == 141
    assert states_in(folder / "m.json") == 2
    assert running.stderr.read() == b""
