"""A rulebook whose names and texts would break out, in every file that is generated of it."""

import ast
import keyword
import os
import re
import shutil
import subprocess
import unicodedata
from dataclasses import replace
from xml.etree import ElementTree

import pytest

import rulec
from rulec.code_generation.compiled_c.c_library import CLibrary
from rulec.code_generation.monitor_files import monitor_texts
from rulec.code_generation.monitor_layout import monitor_layout
from rulec.code_generation.ros2_files import ros2_texts
from rulec.code_generation.rust_files import crate_texts
from rulec.code_generation.written_names import prefix_of
from support.builders.hostile_books import PARTS, hostile
from support.builders.monitored_books import WATCHED

NAMES = ["watched", "car", "stop", "standing", "light", "red", "amber", "green", "speed", "gap"]
NAMES += ["between", "stops", "waits", "keeps_away", "lets_in", "c"]
WRITTEN = {"c": monitor_texts, "ros2": ros2_texts, "rust": crate_texts}


@pytest.fixture(scope="module")
def books():
    """The rulebook as it is, and hostile ones in which each name has another evil one."""
    plain = rulec.compile_rulebook(rulec.parse_rulebook(WATCHED), step_s=1)
    turned = [NAMES[n:] + NAMES[:n] for n in (0, 5, 11)]
    evil = [hostile(plain, names) for names in turned]
    assert {rule.name for book in evil for rule in book.rules} <= {*PARTS}
    return [replace(plain, law="law", as_of="today"), *evil]


def layout_of(book):
    return monitor_layout(book, {})


def in_plain_names(text, book):
    prefix = prefix_of(book.name)
    return text.replace(prefix, "watched").replace(prefix.upper(), "WATCHED")


@pytest.mark.parametrize("language", WRITTEN)
def test_no_text_ends_a_line_or_turns_one_round(books, language):
    plain, *evil = [WRITTEN[language](layout_of(book)) for book in books]
    for book, texts in zip(books[1:], evil, strict=True):
        assert [in_plain_names(path, book) for path in texts] == list(plain)
        for text, own in zip(texts.values(), plain.values(), strict=True):
            assert len(text.splitlines()) == len(own.splitlines())
            shown = text.replace("\n", "").replace("\t", "")
            assert shown.isprintable()
            assert not {"R", "AL", "AN"} & {unicodedata.bidirectional(one) for one in shown}
            harmful = re.compile(r"\?\?[=/'()!<>-]|\\$", re.MULTILINE)
            assert harmful.findall(text) == harmful.findall(own)


def test_what_builds_a_package_is_that_of_any_other(books):
    plain, *evil = [ros2_texts(layout_of(book)) for book in books]
    for book, texts in zip(books[1:], evil, strict=True):
        for path in ("package.xml", "CMakeLists.txt", "launch/monitor.launch.py"):
            assert in_plain_names(texts[path], book) == plain[path]
        ElementTree.fromstring(texts["package.xml"])
        ast.parse(texts["launch/monitor.launch.py"])
        assert re.fullmatch("[a-z](_?[a-z0-9])*", prefix_of(book.name))


def test_messages_have_names_of_ros(books):
    for book in books:
        for path, text in ros2_texts(layout_of(book)).items():
            if not path.startswith("msg/"):
                continue
            lines = [line for line in text.splitlines() if line and not line.startswith("#")]
            fields = [line.split()[1] for line in lines if "=" not in line.split("#")[0]]
            constants = [line.split()[1].split("=")[0] for line in lines if line.split()[1:]]
            constants = [name for name in constants if name not in fields]
            assert all(re.fullmatch("[a-z](_?[a-z0-9])*", name) for name in fields)
            assert [x for x in constants if not re.fullmatch("[A-Z](_?[A-Z0-9])*", x)] == []
            assert len({*fields}) == len(fields)
            assert not any(map(keyword.iskeyword, fields))


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_it_compiles_as_c(books):
    for book in books[1:]:
        CLibrary(layout_of(book), optimised=False)


@pytest.mark.skipif(shutil.which("cargo") is None, reason="there is no cargo")
@pytest.mark.parametrize("place", [1, pytest.param(2, marks=pytest.mark.long)])
def test_it_compiles_as_rust(books, place, tmp_path):
    for name, text in crate_texts(layout_of(books[place])).items():
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, encoding="utf-8")
    build = ["cargo", "build", "--offline", "--quiet"]
    environment = os.environ | {"RUSTFLAGS": "-D warnings"}
    done = subprocess.run(build, cwd=tmp_path, capture_output=True, env=environment)
    assert done.returncode == 0, done.stderr.decode()
