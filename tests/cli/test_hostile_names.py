"""Names from data and files in what every verb prints: none drives a terminal or a runner."""

import csv
import io
import json
import os
import re
from pathlib import Path

import pytest

from rulec.cli.main import main
from rulec.cli.verb_table import COMMANDS, called
from rulec.report.text.outgoing import outgoing, spreadsheet_text

HOSTILE = "\n::error::x\n\x1b]0;own\x07\x9b2J\u202e##[add-mask]y\r##vso[z]\u2028=1+1"
FILE = HOSTILE.replace("/", "")
GOOD = "rulebook good\nuse paper\nhard rule R1 (v: vehicle) { require always not b(v) }\n"
FORBIDDEN = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069\u2028\u2029]"
)
COMMAND = re.compile(r"^\s*::(?!: )|##\[|##vso\[|##teamcity\[", re.MULTILINE)
OWN = re.compile(r"^::(?:error|warning) (?:file=[^\n:]*,)?title=R\d{4}[^\n]*$", re.MULTILINE)

BOOK, TRACES = f"./{FILE}.rules", f"{FILE}.jsonl"
SAFE = "./good.rules"
RUNS = [
    ["analyze", BOOK, "--output-format", "github"],
    ["show", "--audit", BOOK],
    *(["check", ".", "--output-format", form] for form in ("full", "concise", "json", "sarif")),
    ["check", ".", "--output-format", "github"],
    ["check", f"no{HOSTILE}"],
    ["check", "./wrong.rules", f"./{FILE}/"],
    ["compile", SAFE, "-o", f"out{FILE}"],
    ["help", "--completion", "bash"],
    *(["diff", BOOK, SAFE, "--output-format", form] for form in ("text", "csv", "markdown")),
    ["diff", SAFE, "de", "--witness", f"w{FILE}.jsonl", "-o", f"d{FILE}.md"],
    ["doc", BOOK, "--output-format", "markdown"],
    ["draw", "trace", TRACES, "-r", SAFE, "-o", f"{FILE}.svg"],
    ["maneuvers", "--envelopes", f"./{FILE}.toml", "-r", SAFE, "-o", "-"],
    ["explain", HOSTILE],
    ["find", "b(v)", TRACES],
    ["find", "b(v)", TRACES, "--json"],
    ["fleet", TRACES, "-r", SAFE, "-o", f"fleet{FILE}"],
    ["fmt", "--check", "."],
    ["fmt", "--diff", "."],
    ["fmt", f"{FILE}.rules"],
    ["list", "formats"],
    ["help", HOSTILE],
    ["list", HOSTILE],
    ["lsp", HOSTILE],
    ["help", "--man", "-o", f"{FILE}.man"],
    ["maneuvers", f"./{FILE}.toml", "-r", SAFE],
    ["maneuvers", "s1", "-r", f"{FILE}.json"],
    ["monitor", SAFE, "--save", f"{FILE}.saved"],
    ["new", HOSTILE],
    ["new", "name", "-o", f"new{FILE}"],
    ["rates", TRACES],
    ["show", BOOK],
    ["show", f"{FILE}.json"],
    ["test", BOOK, "--output-format", "json"],
    ["test", BOOK],
    ["maneuvers", "--traces", f"./{FILE}.toml", "-o", "-"],
    ["show", "--tree", BOOK],
    ["verify", TRACES, "-r", SAFE],
    ["compile", "--check", f"{FILE}.json"],
    ["compile", "--check", f"a{FILE}.json", "a/good.json"],
    ["verify", TRACES, f"none{FILE}", "-r", SAFE, "--every-part"],
    *(["verify", TRACES, "-r", SAFE, "--output-format", f] for f in ("json", "csv", "jsonl")),
    *(["verify", TRACES, "-r", SAFE, "-o", f"{FILE}.{form}"] for form in ("xml", "sarif", "txt")),
    ["verify", TRACES, "-r", SAFE, HOSTILE],
    [HOSTILE],
    ["check", f"--{HOSTILE}"],
]


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hostile")
    (folder / "good.rules").write_text(GOOD)
    (folder / f"{FILE}.rules").write_text(GOOD.replace("R1 (", "R1   (").replace("good", "bad"))
    (folder / "wrong.rules").write_text(f'rulebook wrong\ntitle "{HOSTILE}"\nhard rule {HOSTILE}')
    (folder / os.fsdecode(b"\xff.rules")).write_text(GOOD.replace("  ", " "))
    (folder / "no_source.rules").write_text("x")
    (folder / f"{FILE}.toml").write_text(f'[scenario]\nname = """{HOSTILE[3:8]}"""\n')
    objects = {HOSTILE: "vehicle", "::add-mask::": "vehicle"}
    states = [{"position": dict.fromkeys(objects, "b")}, {HOSTILE: True}]
    lines = [
        {"id": HOSTILE, "objects": objects, "states": states[:1]},
        {"id": "::t", "objects": objects, "states": states},
        {"id": "u", "objects": {HOSTILE: HOSTILE}, "states": [{}]},
    ]
    (folder / TRACES).write_text("\n".join(map(json.dumps, lines)))
    (folder / "a").mkdir()
    before = Path.cwd()
    os.chdir(folder)
    main(["compile", SAFE, "-o", "a"])
    compiled = (folder / "a" / "good.json").read_text()
    (folder / f"{FILE}.json").write_text(compiled.replace('"good"', json.dumps(HOSTILE)))
    yield folder
    os.chdir(before)


def test_every_verb_is_tried():
    assert {called(run)[0] for run in RUNS} >= COMMANDS.keys()


@pytest.mark.parametrize("arguments", RUNS, ids=lambda run: run[0][:8])
def test_no_line_of_any_output_drives_anything(arguments, tree, capfd, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b'{"b": {"\\n::x": 1}}\n')))
    before = set(tree.iterdir())
    status = main(arguments)
    out, err = capfd.readouterr()
    assert status in (0, 1, 2)
    written = [path for path in set(tree.iterdir()) - before if path.is_file()]
    texts = [path.read_text() for path in written if path.suffix not in (".saved", ".jsonl")]
    for text in (out, err, *texts):
        assert FORBIDDEN.findall(text.replace("\r\n", "\n")) == []
        assert COMMAND.findall(OWN.sub("", text)) == []


def test_the_first_trace_is_judged_and_its_violation_explained(tree, capfd):
    main(["verify", TRACES, "-r", SAFE])
    out = capfd.readouterr().out
    assert "1 violated" in out
    assert "\\x1b]0;own" in out
    assert "state" in out


@pytest.mark.parametrize("form", ["csv", "jsonl"])
def test_data_goes_to_standard_output_whole(form, capfd):
    assert (
        main(["maneuvers", "--traces", "s1", "-o", "-", "--output-format", form, "--first", "3"])
        == 0
    )
    out = capfd.readouterr().out
    assert out.endswith("\n")
    assert len({line.split(",")[0] for line in out.splitlines()}) == 3 + (form == "csv")


def test_csv_has_no_formula(tree, capfd):
    main(["verify", TRACES, "-r", SAFE, "--output-format", "csv"])
    cells = [cell for row in csv.reader(capfd.readouterr().out.splitlines()) for cell in row]
    assert cells
    assert not any(cell.startswith(("=", "+", "@", "-", "\t", "\r")) for cell in cells)


@pytest.mark.parametrize("text", ["=1", "+1", "-1", "@a", "\t=1", "\r=1", "'=1"])
def test_a_cell_that_a_spreadsheet_would_run_is_a_text(text):
    assert spreadsheet_text(text) == f"'{text}"
    assert spreadsheet_text(f"a{text}") == f"a{text}"


def test_what_goes_out_keeps_its_meaning_where_the_format_can_say_it():
    text = "a\x9b\u202eb"
    assert json.loads(outgoing(json.dumps(text, ensure_ascii=False), "json")) == text
    assert outgoing("a\u202eb", "svg") == "a&#x202e;b"
    assert outgoing("\x1b[1mbold\x1b[0m\x1b[2J", color=True) == "\x1b[1mbold\x1b[0m\\x1b[2J"
    assert outgoing("\x1b[1mbold", color=False) == "\\x1b[1mbold"
    assert outgoing(" ::add-mask::x\n##vso[y] a::b") == " \\x3a:add-mask::x\n#\\x23vso[y] a::b"
    assert outgoing("::error title=x::y", "github") == "::error title=x::y"
    assert outgoing("a,b\r\n\x1b\r\n", "csv") == "a,b\r\n\\x1b\r\n"
