"""Compiled rulebooks of one name: told apart by what they were asked for by, at every step."""

import pickle
from fractions import Fraction

import pytest

import rulec
from rulec.api.rulebook_compilation import machines
from rulec.automata.bundle.renamed_rulebook import renamed, with_distinct_names
from rulec.rulebook.files.edition_names import edition_names

TIMED = """rulebook depot
signal p, q default false
hard rule soon { require always (p implies eventually[<= 1 s] q) }
"""
NAME = "depot (old/depot.rules)"


@pytest.mark.parametrize(
    ("names", "files", "expected"),
    [
        (["de", "nl"], ["de", "nl"], ["de", "nl"]),
        (["de", "de"], ["de", "./de.rules"], ["de (de)", "de (de.rules)"]),
        (
            ["de", "nl", "de"],
            ["/a/b/old/de.rules", "nl", "/a/b/new/de.rules"],
            ["de (old/de.rules)", "nl", "de (new/de.rules)"],
        ),
        # Absolute and relative: no common folder.
        (["de", "de"], ["/a/de.rules", "de.rules"], ["de (/a/de.rules)", "de (de.rules)"]),
        # One file named in two ways: as it was given.
        (["de", "de"], ["de.rules", "./de.rules"], ["de (de.rules)", "de (./de.rules)"]),
        (["de", "de"], ["", ""], ["de (1)", "de (2)"]),
        (["de", "de"], ["a", ""], ["de (1)", "de (2)"]),
    ],
)
def test_names_of_editions(names, files, expected):
    assert edition_names(names, files) == expected


def test_a_renamed_rulebook_keeps_its_name_at_every_step():
    book = renamed(machines(rulec.parse_rulebook(TIMED)), NAME)
    fits, other = book.judgeable_at(Fraction(1, 2)), book.at_step(Fraction(3, 10))
    for fitted in (book, fits, other, pickle.loads(pickle.dumps(book)).at_step(Fraction(1))):
        assert fitted.name == NAME
        assert [rule.book for rule in fitted.rules] == [NAME]
    assert fits.rules[0].step_s == Fraction(1, 2)
    # What engines prepare for it is prepared once.
    assert book.judgeable_at(Fraction(1, 2)) is fits


def test_only_editions_of_one_name_are_renamed():
    other = TIMED.replace("depot", "yard")
    books = [machines(rulec.parse_rulebook(text)) for text in (TIMED, other, TIMED)]
    told_apart = with_distinct_names(books, ["old/depot.rules", "yard", "new/depot.rules"])
    assert [book.name for book in told_apart] == [NAME, "yard", "depot (new/depot.rules)"]
    assert told_apart[1] is books[1]
