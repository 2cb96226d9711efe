"""Every room of the package says at its door what it is for and what always holds in it."""

import re
from functools import cache

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


@pytest.mark.parametrize("room", ROOMS, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_what_a_readme_names_without_an_ending_is_a_word_of_the_package(room):
    path = room / "README.md"
    quoted = re.findall(r"`([^`\n]+)`", path.read_text(encoding="utf-8")) if path.exists() else []
    names = {
        name
        for text in quoted
        for name in re.findall(r"(?<![/\w.])[a-z]+(?:_[a-z]+)+\b(?!\.)", text)
    }
    assert {*names} - words() == set()


@cache
def words():
    """The names of modules, and whatever these contain."""
    modules = list(PACKAGE.rglob("*.py"))
    texts = [module.read_text(encoding="utf-8") for module in modules]
    return {module.stem for module in modules}.union(*[re.findall(r"\w+", text) for text in texts])
