"""Automata as lines of text."""

import click
import pytest

from rulec.report.automata.automaton_model import MOST_LINES, Automaton, Transition, as_text

LONG = " or ".join(f"signal_{n}" for n in range(100))

AUTOMATON = Automaton(
    ("open", "violated"),
    (
        Transition(0, 0, LONG, otherwise=False, accepted=True),
        Transition(0, 1, "not a", otherwise=True, accepted=False),
    ),
)


@pytest.mark.parametrize("width", [48, 60, 100])
def test_no_line_is_wider_than_the_terminal(width):
    for line in click.unstyle(as_text(AUTOMATON, width)).split("\n"):
        assert len(line) <= width


def test_a_long_condition_is_cut_and_says_so():
    lines = click.unstyle(as_text(AUTOMATON, 60)).split("\n")
    first = next(n for n, line in enumerate(lines) if "signal_0 " in line)
    last = next(n for n, line in enumerate(lines) if "--json" in line)
    assert last - first == MOST_LINES - 1
    assert "stays" in lines[first]
    assert lines[last + 1].split("  ")[1] == "otherwise"


def test_otherwise_comes_last_whatever_its_target():
    turned = Automaton(AUTOMATON.fates, AUTOMATON.transitions[::-1])
    assert as_text(turned, 100) == as_text(AUTOMATON, 100)
