"""What each page shows is what happens: its commands and programs print what it says they print.

They are run in order, in one folder, on the files that the page has written before. A block below a
line that ends in "`NAME`:" is the file NAME; one with a program is followed by what it prints.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from rulec.api import rulebook_compilation
from rulec.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
PAGES = {
    page.name: page.read_text(encoding="utf-8")
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
}

BLOCK = re.compile(r"^```(\w+)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"`([\w./-]+)`:\n\n$")
COMMAND = r"^\$ ((?:\./)?rulec .*)"


def steps(page):
    """(kind, what, text): a file to write, a command or a program to run with what it prints."""
    program = None
    for block in BLOCK.finditer(page):
        language, text = block.groups()
        if program and language == "text":
            yield "program", program, text
        elif language == "console":
            for command, output in re.findall(
                rf"{COMMAND}\n((?:(?!\$ ).*\n)*)", text, re.MULTILINE
            ):
                yield "command", command, output
        elif named := FILE.search(page, 0, block.start()):
            yield "file", named[1], text
        program = text if language == "python" else None


SESSIONS = {name: tuple(steps(text)) for name, text in PAGES.items()}


IN_A_PROCESS = {"fleet.md", "scenarios.md", "toolchains.md"}
"""Programs of these pages start processes, or load what cannot be unloaded; one is there for all
others, which would only take long to start."""

WRITE_FILES = {"fleet.md"}
"""Programs of these pages are about writing files; others leave none in a reader's checkout."""


def printed(kind, what, capsys, monkeypatch, page):
    if kind == "command":
        what, read = re.fullmatch(r"(.*?)(?: < (\S+))?", what).groups()
        with Path(read or os.devnull).open(encoding="utf-8") as stream:
            monkeypatch.setattr(sys, "stdin", stream)
            main(shlex.split(what)[1:])
        captured = capsys.readouterr()
        return captured.out + captured.err
    if page not in IN_A_PROCESS:
        exec(compile(what, page, "exec"), {"__name__": "__main__"})
        return capsys.readouterr().out
    program = [sys.executable, "-c", what]
    return subprocess.run(program, capture_output=True, text=True, check=True).stdout


COMPILED = {}


def compiled_once(monkeypatch):
    """Let commands have Germany's rulebook, which warns of nothing, from the one before."""
    real = rulebook_compilation.compile_rulebook

    def compiled(rules, *arguments, **settings):
        if rules != "de":
            return real(rules, *arguments, **settings)
        key = tuple(sorted(settings.items()))
        if key not in COMPILED:
            COMPILED[key] = real(rules, *arguments, **settings)
        return COMPILED[key]

    monkeypatch.setattr(rulebook_compilation, "compile_rulebook", compiled)


def without_times(text):
    """The text without times, today, and long digests of rulebooks, which JSON has."""
    took = r"(computed|passed|failed) in [0-9.]+ s"
    changing = rf"{took}|\"seconds\": [0-9.]+|\"at\": \"[0-9-]+|[0-9a-f]{{64}}"
    return re.sub(changing, "", text, flags=re.MULTILINE)


TAKE_SPOT = {"compiled.md", "for_runtime_engineers.md", "toolchains.md"}


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(name, marks=[pytest.mark.spot] if name in TAKE_SPOT else [])
        for name, parts in SESSIONS.items()
        if parts
    ],
)
def test_what_is_shown_is_what_happens(page, tmp_path, monkeypatch, capsys):
    for folder in ("docs", "rulebooks"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    monkeypatch.chdir(tmp_path)
    compiled_once(monkeypatch)
    for kind, what, text in SESSIONS[page]:
        if kind == "file":
            file = (tmp_path / what).resolve()
            assert file.is_relative_to(tmp_path.resolve())
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        else:
            files = set(tmp_path.rglob("*"))
            said = printed(kind, what, capsys, monkeypatch, page)
            if kind == "program" and page not in WRITE_FILES:
                assert set(tmp_path.rglob("*")) == files, what
            assert without_times(said) == without_times(text), what


@pytest.mark.parametrize("page", PAGES)
def test_no_command_is_left_out(page):
    run = [what for kind, what, _ in SESSIONS[page] if kind == "command"]
    assert run == re.findall(COMMAND, PAGES[page], re.MULTILINE)


def test_there_are_commands():
    assert sum(kind == "command" for parts in SESSIONS.values() for kind, _, _ in parts) >= 8
