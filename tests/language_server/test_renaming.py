"""Renaming in all rulebooks of the workspace, or the reason why not."""

import pytest
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException

from support.editor import at, edited, shown

BASE = """\
rulebook ground
use road
topics {
  nearness "Nearness" of keep_far, others
}
param most : speed = 50 km/h
define close(o: vehicle) = gap(o) < 10 m and speed > most
signal odd default false
hard rule keep_far(o: vehicle) {
  require always (close(o) implies not (odd and oncoming_o))
  accept { gap_o = 20 m; oncoming(o) }
}
"""
UPON = """\
rulebook over
extends ground
set most = 30 km/h
override rule keep_far {
  also unless close(o) and odd at some point
}
"""


@pytest.fixture(scope="module")
def books(editor):
    assert editor.open("ground.rules", BASE) == []
    assert editor.open("over.rules", UPON) == []
    return editor


def renamed(editor, name, position, new):
    """The texts of both books after a renaming."""
    params = editor.position_params(lsp.RenameParams, name, position, new_name=new)
    changes = editor.ask(lsp.TEXT_DOCUMENT_RENAME, params).changes
    texts = {"ground.rules": BASE, "over.rules": UPON}
    return [edited(text, changes.get(editor.uri(file), [])) for file, text in texts.items()]


def refused(editor, name, position, new):
    with pytest.raises(JsonRpcException) as problem:
        renamed(editor, name, position, new)
    return str(problem.value)


def test_a_parameter_in_all_books(books):
    ground, over = renamed(books, "over.rules", at(UPON, "set most"), "top_speed")
    assert ground == BASE.replace("most", "top_speed")
    assert over == UPON.replace("set most", "set top_speed")


def test_a_definition_and_a_signal(books):
    ground, over = renamed(books, "ground.rules", at(BASE, "define close"), "near")
    assert (ground, over) == (BASE.replace("close", "near"), UPON.replace("close", "near"))
    ground, over = renamed(books, "over.rules", at(UPON, "and odd"), "strange")
    assert (ground, over) == (BASE.replace("odd", "strange"), UPON.replace("odd", "strange"))


def test_a_rule_keeps_its_topic(books):
    ground, over = renamed(books, "ground.rules", at(BASE, "rule keep_far"), "distance")
    assert ground == BASE.replace("keep_far", "distance")
    assert over == UPON.replace("keep_far", "distance")


def test_only_topics_that_know_a_rule_by_most_of_its_name_list_it_anew(editor):
    text = (
        "rulebook listed\nsignal fog\n"
        'topics { wide "Wide" of stay; narrow "Narrow" of stay_far }\n'
        "hard rule stay_far { require never fog }\n"
        "hard rule stay_left { require never fog }\n"
    )
    assert editor.open("listed.rules", text) == []
    params = editor.position_params(
        lsp.RenameParams, "listed.rules", at(text, "rule stay_far"), new_name="distance"
    )
    changes = editor.ask(lsp.TEXT_DOCUMENT_RENAME, params).changes
    now = edited(text, changes[editor.uri("listed.rules")])
    assert now == text.replace("stay_far", "distance")
    params.new_name, params.position = "left", at(text, "rule stay_left")
    changes = editor.ask(lsp.TEXT_DOCUMENT_RENAME, params).changes
    now = edited(text, changes[editor.uri("listed.rules")])
    assert now == text.replace("stay_left", "left").replace("of stay;", "of stay, left;")


def test_a_variable_also_in_short_forms(books):
    ground, over = renamed(books, "ground.rules", at(BASE, "keep_far(o"), "car")
    rule = BASE[BASE.index("hard") :]
    there = rule.replace("far(o:", "far(car:").replace("(o)", "(car)").replace("_o ", "_car ")
    assert ground == BASE.replace(rule, there.replace("_o)", "_car)"))
    assert over == UPON.replace("close(o)", "close(car)")


@pytest.mark.parametrize(
    ("new", "why"),
    [
        ("until", "a word of the language"),
        ("2fast", "is not a name"),
        ("odd", "there would be a mistake"),
        ("gap", "there would be a mistake"),
    ],
)
def test_a_name_that_cannot_be(books, new, why):
    assert why in refused(books, "ground.rules", at(BASE, "param most"), new)


def test_a_word_of_a_vocabulary_that_ships_stays(books):
    said = refused(books, "ground.rules", at(BASE, "= gap"), "distance")
    assert "declared in" in said
    assert "outside of the editor's folders" in said


def test_a_book_keeps_the_name_of_its_file(books):
    assert "the name of its file" in refused(books, "over.rules", at(UPON, "extends ground"), "x")


def test_what_can_be_renamed_is_known_before(books):
    params = books.position_params(lsp.PrepareRenameParams, "over.rules", at(UPON, "set most"))
    found = books.ask(lsp.TEXT_DOCUMENT_PREPARE_RENAME, params)
    assert (found.placeholder, shown(UPON, found.range)) == ("most", "most")


def test_with_a_mistake_in_a_book_nothing_is_renamed(books):
    books.open("over.rules", UPON.replace("and odd", "and"))
    assert "fix them first" in refused(books, "ground.rules", at(BASE, "define close"), "near")
    assert books.open("over.rules", UPON) == []
