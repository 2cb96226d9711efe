"""Benchmarks say what was wanted and whether it was reached, and break when their work does."""

import re
import subprocess
import sys
from pathlib import Path

import every
import pytest
from figure import Figure, Result, number
from page import as_lines, tables

HERE = Path(__file__).parent
ROOT = HERE.parents[1]


@pytest.mark.parametrize(
    ("figure", "is_reached"),
    [
        (Figure("x", "ns", 0.3, 0.1, most=0.3), True),
        (Figure("x", "ns", 0.31, 0.1, most=0.3), False),
        (Figure("x", "ns", 9, 9, peer="y", ratio=4), True),
        (Figure("x", "ns", 0.2, 0.1, 0.3, "y", 1500, 1500), True),
        (Figure("x", "ns", 0.2, 0.1, 0.3, "y", 1499, 1500), False),
        (Figure("x", "ns", 0.4, 0.1, 0.3, "y", 1500, 1500), False),
    ],
)
def test_a_figure_is_reached_by_its_median_and_its_ratio(figure, is_reached):
    assert figure.is_reached is is_reached


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.12345, "0.123"), (1.2345, "1.23"), (12.345, "12.3"), (123.45, "123"), (12345.6, "12,346")],
)
def test_numbers_have_three_digits_that_say_something(value, text):
    assert number(value) == text


def test_the_tables_say_what_was_missed():
    figures = [
        Figure("slow | thing", "ns", 0.4, 0.2, 0.3),
        Figure("quick thing", "ms", 2, 1, 4, "a peer", 10.04),
    ]
    found = {"name": [Result("A title", "an input", figures, ["a note"])]}
    text = tables(as_lines(found, ["a machine"]))
    assert "- a machine\n\n## A title\n\n`name`: an input.\n\n| figure |" in text
    assert "\n| slow \\| thing | ≤ 0.3 ns, missed | 0.400 ns | 0.200 ns |  |\n" in text
    assert "\n| quick thing | ≤ 4 ms | 2.00 ms | 1.00 ms | 10.0× a peer |\n\n- a note" in text


def test_every_benchmark_is_in_the_file():
    written = tables(every.KEPT.read_bytes())
    programs = {path.stem for path in HERE.glob("*.py") if "\ndef measure(" in path.read_text()}
    assert {name for name in programs if f"\n`{name}`: " in written} == programs
    assert "compiling" in programs


def test_every_section_is_one_that_a_benchmark_makes():
    written = tables(every.KEPT.read_bytes())
    sections = re.findall(r"^## (.+)\n\n`(\w+)`: ", written, re.M)
    assert len(sections) == written.count("\n## ") > 30
    for title, name in sections:
        # What a figure is of stands behind a colon.
        assert f'"{title.partition(":")[0]}' in (HERE / f"{name}.py").read_text(), title


def run(*arguments):
    command = [sys.executable, str(HERE / "every.py"), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.spot
def test_a_benchmark_by_name_prints_its_table_and_the_machine():
    done = run("compiling", "--rounds", "1")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("Compiling\n  the 169 patterns of the literature in spot.gen")
    assert "\n  the 55 of dac " in done.stdout
    assert "load average" in done.stdout


@pytest.mark.parametrize("arguments", [["nothing"], ["--write", "batch"], ["--rounds", "0"]])
def test_what_cannot_be_run_is_said(arguments):
    done = run(*arguments)
    assert (done.returncode, done.stdout) == (2, "")
    assert "Error: " in done.stderr


def test_a_benchmark_that_breaks_is_said(monkeypatch, tmp_path, capfd):
    (tmp_path / "fails.py").write_text("raise RuntimeError('no figures')")
    monkeypatch.setattr(every, "HERE", tmp_path)
    assert every.measured("fails", None) is None
    said = capfd.readouterr()
    assert said.out == ""
    assert said.err.endswith("RuntimeError: no figures\nthe benchmark fails broke\n")


@pytest.mark.spot
def test_benchmarks_find_what_they_import():
    program = f"import sys; sys.path.insert(0, {str(HERE)!r}); import {', '.join(every.NAMES)}"
    environment = every.environment()
    subprocess.run([sys.executable, "-c", program], check=True, env=environment, cwd=ROOT)
