"""The pictures of the documentation are those that its commands draw."""

import re
import shlex
from pathlib import Path

import pytest

from rulec.cli.main import main
from support.builders.recorded_data import RECORDINGS

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "pictures"
PAGE = (ROOT / "docs" / "pictures.md").read_text()
COMMANDS = re.findall(r"^\$ \./rulec (draw .*?) -o (\w+\.svg)$", PAGE, re.MULTILINE)
OF_RECORDINGS = re.findall(r"^\./rulec (draw .*?) -o (\w+\.svg)$", PAGE, re.MULTILINE)
"""Of recordings that do not ship."""


@pytest.mark.parametrize(("command", "name"), COMMANDS)
def test_a_picture_is_up_to_date(command, name, tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    main([*shlex.split(command), "-o", str(tmp_path / name)])
    assert (tmp_path / name).read_bytes() == (FOLDER / name).read_bytes()


@pytest.mark.skipif(not RECORDINGS.is_dir(), reason="there are no shared recordings")
@pytest.mark.parametrize(("command", "name"), OF_RECORDINGS)
def test_a_picture_of_a_recording_is_up_to_date(command, name, tmp_path, monkeypatch):
    monkeypatch.chdir(RECORDINGS)
    main([*shlex.split(command), "-o", str(tmp_path / name)])
    assert (tmp_path / name).read_bytes() == (FOLDER / name).read_bytes()


def test_every_picture_has_its_command():
    assert {name for _, name in COMMANDS + OF_RECORDINGS} == {
        file.name for file in FOLDER.iterdir()
    }
