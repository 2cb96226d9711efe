"""The pictures of the documentation are those that its commands draw."""

import re
import shlex
from pathlib import Path

import pytest

from rulec.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "pictures"
COMMANDS = re.findall(
    r"^\$ \./rulec (draw .*?) -o (\w+\.svg)$",
    (ROOT / "docs" / "pictures.md").read_text(),
    re.MULTILINE,
)


@pytest.mark.parametrize(("command", "name"), COMMANDS)
def test_a_picture_is_up_to_date(command, name, tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    main([*shlex.split(command), "-o", str(tmp_path / name)])
    assert (tmp_path / name).read_bytes() == (FOLDER / name).read_bytes()


def test_every_picture_has_its_command():
    assert {name for _, name in COMMANDS} == {file.name for file in FOLDER.iterdir()}
