"""docs/rulebooks.md: its tables name what there is, its sample is a rulebook."""

import re
from pathlib import Path

import pytest

from rulec.automata.compiler import compile_rulebook
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.rulebook.loader import load_rulebook, parse_rulebook
from support.builders.national_books import FOLDER, NATIONAL, read, rules_on

# Books of what vehicles must do to be approved are no traffic law, and not asked what that says.
TYPE_APPROVAL = "un-"

PAGE = (Path(__file__).parents[2] / "docs" / "rulebooks.md").read_text(encoding="utf-8")


def first_cells(head):
    """What the first column of the table below a head names."""
    table = PAGE[PAGE.index(head) :].split("\n\n", 1)[0]
    return re.findall(r"^\| `([\w-]+)`", table, re.MULTILINE)


SHARED = first_cells("| rule | pattern |")


def test_every_book_has_its_row():
    assert sorted(first_cells("| book | law |")) == NATIONAL


@pytest.mark.parametrize("name", NATIONAL)
def test_a_row_says_what_the_book_says_of_itself(name):
    rulebook = read(name).rulebook
    (row,) = re.findall(rf"^\| `{name}` \|.*", PAGE, re.MULTILINE)
    assert row.split(" | ")[2:4] == [rulebook.as_of, rulebook.traffic]


def test_twenty_rules_are_shared():
    assert len(SHARED) == len(set(SHARED)) == 20


@pytest.mark.parametrize("name", [one for one in NATIONAL if not one.startswith(TYPE_APPROVAL)])
def test_a_book_answers_every_shared_question_or_says_that_it_does_not(name):
    said = {one.name for one in read(name).rulebook.remarks if one.kind in ("silent", "dropped")}
    assert [one for one in SHARED if not rules_on(name, [one]) and one not in said] == []


@pytest.mark.parametrize("name", NATIONAL)
def test_shared_rules_are_on_the_level_of_the_table(name):
    levels = dict(re.findall(r"^\| `(\w+)` \|.*\| (\w+) \|$", PAGE, re.MULTILINE))
    for rule in read(name).rulebook.rules:
        assert rule.level == levels.get(rule.name, rule.level), rule.name


def test_the_options_are_those_of_the_treaty():
    written = (FOLDER / "vienna" / "vienna.rules").read_text(encoding="utf-8")
    options = re.findall(r"^option (\w+)", written, re.MULTILINE)
    assert sorted(first_cells("| option | article |")) == sorted(options)


def test_the_sample_is_a_rulebook():
    (text,) = re.findall(r"^```rulec\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    rulebook = parse_rulebook(text)
    outcomes = run_rulebook_examples(rulebook, compile_rulebook(rulebook)).outcomes
    assert outcomes
    assert all(one.passed for one in outcomes)
    assert rulebook.levels == load_rulebook("schemas").levels
