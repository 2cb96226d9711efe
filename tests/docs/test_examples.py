"""The examples of the documentation run, and what it shows of Python needs `rulec` alone."""

import ast
import json
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

import rulec

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "docs" / "examples"
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
OWN_FILES = {"architecture.md"}


def notebook_cells(path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [], "outputs are cleared"
            yield "".join(cell["source"])


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.ipynb")), ids=lambda path: path.stem)
def test_notebooks(path):
    names = {}
    for text in notebook_cells(path):
        tree = ast.parse(text)
        # The last line of a cell is shown.
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, path.name, "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), path.name, "eval"), names)
            assert len(repr(value)) < 2000


STARTS_PROCESSES = {"many_processes", "watch_over_udp"}
"""All others run in this one, where what they import is there, and what they compile known."""


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_scripts(path, capsys):
    if path.stem in STARTS_PROCESSES:
        done = subprocess.run([sys.executable, path], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout
    else:
        runpy.run_path(str(path), run_name="__main__")
        out, err = capsys.readouterr()
        assert (bool(out), err) == (True, "")


DATAGRAM_BYTES = 65_507
ODD_STATES = {
    "nested": b"[" * 60_000,
    "nested in a state": b'{"state": {"position": ' + b'{"a":' * 9000 + b"1" + b"}" * 9002,
    "longer when answered": json.dumps({"state": {"ä" * 30_000: 1}}, ensure_ascii=False).encode(),
    "digits": b'{"state": {"position": ' + b"1" * 5000 + b"}}",
    "not text": b"\xff\xfe\x00",
    "no object": b"null",
    "no state": b"{}",
}


@pytest.mark.parametrize("data", ODD_STATES.values(), ids=ODD_STATES)
@pytest.mark.parametrize("example", ["watch_over_udp", "watch_over_zenoh"])
def test_whatever_is_sent_to_a_watch_is_answered(example, data):
    names = runpy.run_path(str(EXAMPLES / f"{example}.py"))
    monitor = rulec.Monitor(rulec.compile_rulebook("esterle2019"))
    assert len(data) <= DATAGRAM_BYTES
    answer = names["answer_to"](data, monitor)
    assert list(answer) == ["error"]
    assert len(json.dumps(answer).encode()) <= DATAGRAM_BYTES
    (state, *_) = names["PASSING_ON_THE_RIGHT"]
    assert names["answer_to"](json.dumps(state).encode(), monitor)["number"] == 0


def programs():
    for page in PAGES:
        if page.name not in OWN_FILES:
            for text in re.findall(r"^```python.*?\n(.*?)^```", page.read_text(), re.M | re.S):
                yield page.name, text
    for path in sorted(EXAMPLES.iterdir()):
        texts = notebook_cells(path) if path.suffix == ".ipynb" else [path.read_text()]
        yield from ((path.name, text) for text in texts)


def imported(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module


def test_what_is_shown_imports_from_rulec_alone():
    inner = [
        (page, module)
        for page, text in programs()
        for module in imported(text)
        if module.startswith("rulec.") and module != "rulec.fleet"
    ]
    assert inner == []
    assert len(list(programs())) > 10
