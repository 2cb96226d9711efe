"""What rules rest on can be told, or the book says that it cannot; and how much the books cover."""

from functools import cache

import pytest

import rulec
from rulec.analysis.audit.source_audit import audit_source
from rulec.logic.free_names import names_in
from rulec.rulebook import loader
from rulec.rulebook.names.doc_comments import description
from rulec.syntax import decode, tree
from support.builders.national_books import FOLDER, NATIONAL, compiled, read
from tools.coverage_table import coverage_table

TOLD = frozenset().union(*(listed.words or () for listed in rulec.formats()))
"""What some file of some format tells."""

UNTOLD = "No format tells"
OF_THE_PLACE = "Map: "
"""How the description of a word begins that is a fact of a place or of a vehicle.

Who has a recording knows it, or can look it up, and says it by ``--assume``.
"""

FOURTEEN = (
    *("vienna", "de", "at", "fr", "nl", "se", "pl"),
    *("gb", "ie", "it", "us-ca", "au-nsw", "jp", "in"),
)


@cache
def descriptions() -> dict[str, frozenset[str]]:
    """Each word of a shipped file, with what the files say of it."""
    found: dict[str, frozenset[str]] = {}
    for path in sorted(FOLDER.glob("*/*.rules")):
        file, mistakes = loader.parsed(decode(str(path), path.read_bytes()))
        assert mistakes == ()
        for item in _inside(file.items):
            if isinstance(item, tree.SignalItem):
                names = [one.name.text for one in item.signals]
            elif isinstance(item, tree.QuantityItem | tree.EnumerationItem):
                names = [item.name.text]
            else:
                names = []
            for name in names:
                found[name] = found.get(name, frozenset()) | {description(item.span)}
    return found


def _inside(items):
    for item in items:
        yield item
        yield from _inside(getattr(item, "items", ()))


def read_by(rule):
    return frozenset(names_in(rule.formula))


@pytest.mark.parametrize("name", NATIONAL)
def test_what_no_format_tells_is_a_fact_of_the_place_or_says_that_nobody_tells_it(name):
    declared = read(name).rulebook.vocabulary.declarations
    for rule in read(name).rulebook.rules:
        for word in (read_by(rule) & frozenset(declared)) - TOLD:
            for said in descriptions()[word]:
                assert said.startswith(OF_THE_PLACE) or UNTOLD in said, f"{rule.name}: {word}"


def test_nothing_that_a_format_tells_is_said_to_be_untold():
    assert [word for word in TOLD for said in descriptions().get(word, ()) if UNTOLD in said] == []


def test_few_of_the_german_rules_read_what_no_format_tells():
    """Zones where people on foot go first are on no map that is read."""
    audit = audit_source(compiled("de"), "all formats", TOLD)
    partly = [one.rule for one in audit.rules if one.untold or one.lacking]
    assert len(partly) <= 0.21 * len(audit.rules)
    assert {one.rule for one in audit.rules if one.basis == "nothing"} <= set(partly)


def test_three_fifths_of_the_cells_of_the_first_fourteen_books_are_whole():
    lines = coverage_table().splitlines()
    (head,) = (line for line in lines if line.startswith("| topic |"))
    books = [cell.strip().strip("`") for cell in head.strip("|").split("|")][1:]
    begin = lines.index(head) + 2
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[begin:-1]]
    cells = {
        (row[0], book): sign for row in rows for book, sign in zip(books, row[1:], strict=True)
    }
    assert len(rows) == 58
    whole = sum(sign == "●" for (_, book), sign in cells.items() if book in FOURTEEN)
    assert whole >= 0.6 * len(rows) * len(FOURTEEN)
    for row in rows:
        assert any(sign[0] in "●◐" for sign in row[1:]), row[0]
