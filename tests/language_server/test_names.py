"""What names mean, where they come from and where they are used."""

import pytest
from lsprotocol import types as lsp

from support.editor import at, shown

BASE = """\
rulebook base
law "Road Traffic Act" as of 2020-01-01
use road
provisions "https://example.org/act" { "Art. 5" "Speed" }
param most : speed = 50 km/h if built_up else 100 km/h
option strict = on  # beyond the law
# Ego is too close to it.
define close(o: vehicle) = gap(o) < 10 m
hard rule keep_slow(o: vehicle) {
  cite "Art. 5(1)"
  says "Slow down near others."
  require always (close(o) implies speed <= most)
}
"""
UPON = """\
rulebook upon
extends base
law "Depot's Order" as of 2021-05-05
set most = 30 km/h
override rule keep_slow {
  unless gap_o > 5 m and strict
}
"""


@pytest.fixture(scope="module")
def books(editor):
    # Only the book upon it uses the option.
    assert [one.code for one in editor.open("base.rules", BASE)] == ["R0208"]
    assert editor.open("upon.rules", UPON) == []
    return editor


def hovered(editor, name, position):
    params = editor.position_params(lsp.HoverParams, name, position)
    found = editor.ask(lsp.TEXT_DOCUMENT_HOVER, params)
    return "" if found is None else found.contents.value


def test_a_quantity_says_its_unit_its_meaning_and_who_supplies_it(books):
    text = hovered(books, "base.rules", at(BASE, "gap(o) <", "ap("))
    assert "quantity gap(o: road_user) in m default 1000" in text
    assert "The distance along the road between ego and o." in text
    assert "Supplied by the scene" in text
    assert "vocabulary `road`" in text


def test_a_parameter_says_its_value_on_the_day(books):
    text = hovered(books, "upon.rules", at(UPON, "set most", "ost"))
    assert "On 2021-05-05: **30 km/h**" in text
    assert "50 km/h if built_up else 100 km/h" in text


def test_a_rule_says_its_provision_and_the_heading_of_its_article(books):
    text = hovered(books, "upon.rules", at(UPON, "keep_slow"))
    assert "**Art. 5(1)**, Speed, law of `base`" in text
    assert "Slow down near others." in text


def test_a_definition_and_an_option_say_what_they_are(books):
    assert "Ego is too close to it." in hovered(books, "base.rules", at(BASE, "(close", "lose"))
    assert "option strict = on" in hovered(books, "upon.rules", at(UPON, "strict", "rict"))
    assert "beyond the law" in hovered(books, "upon.rules", at(UPON, "strict", "rict"))


def test_a_variable_says_its_type(books):
    assert "o: vehicle" in hovered(books, "base.rules", at(BASE, "(close(o", "o)"[:1], nth=0))


def test_nothing_is_said_of_what_is_no_name(books):
    assert hovered(books, "base.rules", at(BASE, "require", "quire")) == ""


def defined(editor, name, position):
    params = editor.position_params(lsp.DefinitionParams, name, position)
    return editor.ask(lsp.TEXT_DOCUMENT_DEFINITION, params)


def test_a_rule_is_defined_where_it_was_first_written(books):
    found = defined(books, "upon.rules", at(UPON, "keep_slow"))
    assert found.uri == books.uri("base.rules")
    assert shown(BASE, found.range) == "keep_slow"


def test_a_word_is_defined_in_its_vocabulary(books):
    found = defined(books, "upon.rules", at(UPON, "gap_o", "ap"))
    assert found.uri.endswith("/vocabulary/road.rules")


def test_the_short_form_of_an_atom_leads_to_its_variable(books):
    found = defined(books, "upon.rules", at(UPON, "gap_o"))
    assert found.uri == books.uri("base.rules")
    assert found.range.start == at(BASE, "keep_slow(o: ", "o: ")


def test_the_book_that_one_extends_is_a_file(books):
    found = defined(books, "upon.rules", at(UPON, "extends base", "ase"))
    assert (found.uri, found.range.start) == (books.uri("base.rules"), lsp.Position(0, 0))


def test_references_are_found_in_all_books(books):
    params = books.position_params(
        lsp.ReferenceParams,
        "base.rules",
        at(BASE, "param most", "ost"),
        context=lsp.ReferenceContext(include_declaration=True),
    )
    found = books.ask(lsp.TEXT_DOCUMENT_REFERENCES, params)
    texts = {books.uri("base.rules"): BASE, books.uri("upon.rules"): UPON}
    assert [shown(texts[one.uri], one.range) for one in found] == ["most"] * 3
    assert [one.uri for one in found] == [books.uri("base.rules")] * 2 + [books.uri("upon.rules")]
    params.context = lsp.ReferenceContext(include_declaration=False)
    assert len(books.ask(lsp.TEXT_DOCUMENT_REFERENCES, params)) == 2
