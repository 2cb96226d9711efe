"""docs/coming_from.md: each habit has a command that is answered."""

import io
import re
import shlex
from pathlib import Path

import pytest

from rulec.cli.main import main

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/coming_from.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| (.*?) \| (.*?) \| (.*) \|$", PAGE, re.MULTILINE)[1:]
COMMANDS = re.findall(r"`rulec ((?!lsp)[^`]+)`", "\n".join(here for *_, here in ROWS))
COMPLETE = [one for one in COMMANDS if one not in ("new", "check --fix", "check --lock")]


def test_there_are_25_habits():
    assert len(ROWS) == 25
    assert all("`" in here or "](" in here for *_, here in ROWS)


@pytest.mark.long
def test_their_commands_are_answered(tmp_path, monkeypatch, capsys):
    for name in ("rulebooks", "docs"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    for command in COMPLETE:
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b'{"state": {}}\n')))
        status = main(shlex.split(command))
        out, err = capsys.readouterr()
        assert status in (0, 1), (command, err)
        silent = "github" in command or "monitor" in command  # where nothing is found, or asked
        assert out or err or silent, command
    assert len(COMPLETE) >= 25
