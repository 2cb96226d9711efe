"""Every room of the package says at its door what it is for and what always holds in it."""

import re

import pytest

from support.source_modules import PACKAGE, rooms

ROOMS = [path for path in rooms() if path != PACKAGE]


@pytest.mark.parametrize("room", ROOMS, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_room_has_its_readme(room):
    text = (room / "README.md").read_text(encoding="utf-8")
    assert "Purpose" in text
    assert "Invariant" in text
    assert "oes not know about" in text
    assert len(text.splitlines()) <= 40


@pytest.mark.parametrize("room", ROOMS, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_what_a_readme_names_is_there(room):
    path = room / "README.md"
    if not path.exists():
        return
    named = re.findall(r"`([a-z_/]+\.py|[a-z_/]+/)`", path.read_text(encoding="utf-8"))
    for name in named:
        assert (PACKAGE.parents[1] / name).exists() or any(PACKAGE.rglob(name)), name
