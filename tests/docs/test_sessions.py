"""The commands of each page print what the page shows, run in order on the files that it writes.

A block below a line that ends in "`NAME`:" is the file NAME.
"""

import re
import shlex
from pathlib import Path

import pytest

from rulec.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]

BLOCK = re.compile(r"^([^\n]*)\n\n```(\w+)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"`([\w./-]+)`:$")
NOT_OURS = ("tests/run", "cd ", "pip ", "sphinx-build ")


def steps(page):
    """(file, text) for what is to be written, (command, output) for what is to be run."""
    for before, language, text in BLOCK.findall("\n" + page.read_text(encoding="utf-8")):
        if language == "console":
            for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
                command, _, output = part.partition("\n")
                if not command.startswith(NOT_OURS):
                    yield f"$ {command}", output
        elif named := FILE.search(before):
            yield named[1], text


SESSIONS = {page.name: tuple(steps(page)) for page in PAGES}
WITH_COMMANDS = [
    name for name, parts in SESSIONS.items() if any(head[0] == "$" for head, _ in parts)
]


def without_times(text):
    return re.sub(r"computed in .* s|\"seconds\": [0-9.]+", "", text)


@pytest.mark.parametrize("page", WITH_COMMANDS)
def test_commands_print_what_is_shown(page, tmp_path, monkeypatch, capsys):
    for folder in ("docs", "rulebooks"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    monkeypatch.chdir(tmp_path)
    for head, text in SESSIONS[page]:
        if head.startswith("$ "):
            program, *arguments = shlex.split(head[2:])
            assert program in ("rulec", "./rulec")
            main(arguments)
            captured = capsys.readouterr()
            assert without_times(captured.out + captured.err) == without_times(text), head
        else:
            file = tmp_path / head
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")


def test_every_command_is_found():
    for page in PAGES:
        shown = re.findall(
            r"^\$ ((?:\./)?rulec .*)", page.read_text(encoding="utf-8"), re.MULTILINE
        )
        assert [head[2:] for head, _ in SESSIONS[page.name] if head[0] == "$"] == shown
    assert len(WITH_COMMANDS) >= 3
