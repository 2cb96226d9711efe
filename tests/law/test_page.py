"""docs/rulebooks.md: its tables name what there is, its sample is a rulebook."""

import re
from pathlib import Path

import pytest

from rulec.automata.compiler import compile_rulebook
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.names.referenced_names import parts_of
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.syntax import decode, parse, tree
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


def patterns_of(kind):
    """The patterns that the table of kinds lists as ``kind``."""
    (row,) = re.findall(rf"^\| {kind}[^|]*\|.*\| ([^|]*) \|$", PAGE, re.MULTILINE)
    return re.findall(r"`(\w+)`", row)


WRONG, RIGHT, SITUATIONS = map(patterns_of, ("what is wrong", "what is right", "a situation"))


def signs(formula, sign=1):
    """The names in a formula, each with 1 if more of it keeps the rule, -1 if more violates it."""
    match formula:
        case tree.AtomUse(name=name):
            yield name.text, sign
        case tree.Prefix(operator="not", operand=operand):
            yield from signs(operand, -sign)
        case tree.Prefix(operator="never", operand=operand):
            yield from signs(operand, -sign)
        case tree.Infix(operator="implies", left=left, right=right):
            yield from signs(left, -sign)
            yield from signs(right, sign)
        case _:
            for part in parts_of(formula):
                yield from signs(part, sign)


def uses():
    """How the rules of all books use each pattern: the set of its signs."""
    found = {}
    for path in sorted(FOLDER.glob("*/*.rules")):
        file, mistakes = parse(decode(path.name, path.read_bytes()))
        assert not mistakes
        for item in file.items:
            if isinstance(item, tree.RuleItem) and item.require is not None:
                for name, sign in signs(item.require):
                    found.setdefault(name, set()).add(sign)
    return found


def test_patterns_are_used_as_the_page_says():
    found = uses()
    assert {name: found.get(name) for name in RIGHT} == {name: {1} for name in RIGHT}
    others = [*WRONG, *SITUATIONS]
    assert {name: found.get(name) for name in others} == {name: {-1} for name in others}


def test_each_pattern_of_the_tables_of_rules_has_a_kind():
    written = (FOLDER / "schemas" / "schemas.rules").read_text(encoding="utf-8")
    patterns = set(re.findall(r"^define (\w+)", written, re.MULTILINE))
    rows = re.findall(r"^\| `\w+` \| ([^|]*) \| [^|]* \| \w+ \|$", PAGE, re.MULTILINE)
    alone = [re.sub(r"\([^()]*\)", "", row) for row in rows]
    named = {name for row in alone for name in re.findall(r"\w+", row)} & patterns
    assert len(named) > 20
    assert sorted(named - {*WRONG, *RIGHT, *SITUATIONS}) == []
