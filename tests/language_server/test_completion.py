"""What fits at the cursor: by the grammar, by types, by who it is about."""

import pytest
from lsprotocol import types as lsp

from support.editor import at, shown

BOOK = """\
rulebook typed
extends vienna
param least : length = 3 m
param longest : time = 3 s
define near(o: vehicle, other: pedestrian) = gap(o) < least

hard rule first(o: vehicle, who: pedestrian) {
  require always (stopped(o) and near(o, who))
}
"""


def completed(editor, name, text, position):
    editor.open(name, text)
    params = editor.position_params(lsp.CompletionParams, name, position)
    found = editor.ask(lsp.TEXT_DOCUMENT_COMPLETION, params)
    items = getattr(found, "items", found)
    return {item.label: item for item in items}


def labels_in(editor, before, after="", text=BOOK):
    """The labels where ``before`` has been typed for the rule's requirement."""
    start, rest = text.split("require ")
    whole = f"{start}{before}{after}{rest[rest.index(chr(10)) :]}"
    return completed(editor, "typed.rules", whole, at(whole, before))


def test_an_item_begins_with_its_words(editor):
    found = completed(editor, "begun.rules", BOOK + "\nha", at(BOOK + "\nha", "}\n\nha"))
    assert {"hard rule", "override rule", "define"} <= found.keys()
    assert "accept" not in found


def test_a_clause_begins_with_its_words(editor):
    found = labels_in(editor, "  c")
    assert {"cite", "require", "also unless", "accept"} <= found.keys()
    assert "hard rule" not in found


def test_words_of_objects_come_with_the_variables_that_fit(editor):
    found = labels_in(editor, "require always st")
    assert {"stopped(o)", "stopped(who)", "emergency_vehicle_near", "near(o, who)"} <= found.keys()
    assert found["stopped(o)"].detail == "of an object, road_user"
    assert found["built_up"].detail == "of ego or the world"
    assert "least" in found
    assert "not" in found


def test_only_fitting_variables_are_arguments(editor):
    assert set(labels_in(editor, "require always near(")) == {"o"}
    assert set(labels_in(editor, "require always near(o, ")) == {"who"}


def test_beside_a_length_stand_lengths(editor):
    found = labels_in(editor, "require always gap(o) < ")
    assert {"least", "gap(o)", "lateral_gap(who)"} <= found.keys()
    assert not {"longest", "speed", "stopped(o)", "built_up"} & found.keys()


def test_behind_a_formula_stand_operators_and_clauses(editor):
    found = labels_in(editor, "require always built_up ")
    assert {"and", "implies", "until", "unless"} <= found.keys()
    assert "built_up" not in found


def test_names_of_books_rules_and_types(editor):
    text = "rulebook named\nextends \n"
    assert {"vienna", "de"} <= completed(editor, "named.rules", text, at(text, "extends ")).keys()
    text = BOOK + "override rule \n"
    found = completed(editor, "overriding.rules", text, at(text, "override rule "))
    assert "near_side_passing" in found
    assert "first" not in found
    text = BOOK.replace("(o: vehicle, who", "(o: ve, who")
    found = completed(editor, "types.rules", text, at(text, "first(o: ve"))
    assert {"vehicle", "car"} <= found.keys()
    text = BOOK + "set \n"
    assert "strict_crossings" in completed(editor, "setting.rules", text, at(text, "\nset "))


def test_the_begun_word_is_replaced(editor):
    text = BOOK.replace("stopped(o)", "stop")
    item = completed(editor, "replaced.rules", text, at(text, "(stop"))["stopped(o)"]
    assert shown(text, item.text_edit.range) == "stop"


def test_nothing_is_offered_in_comments_and_texts(editor):
    text = BOOK.replace("  require", '  says "st"  # st\n  require')
    assert completed(editor, "quiet.rules", text, at(text, 'says "st')) == {}
    assert completed(editor, "quiet.rules", text, at(text, "# st")) == {}


def test_a_call_shows_its_parameters(editor):
    editor.open("called.rules", BOOK)
    params = editor.position_params(
        lsp.SignatureHelpParams, "called.rules", at(BOOK, "and near(o, ")
    )
    found = editor.ask(lsp.TEXT_DOCUMENT_SIGNATURE_HELP, params)
    (one,) = found.signatures
    assert one.label == "near(o: vehicle, other: pedestrian)"
    assert found.active_parameter == 1
    params.position = at(BOOK, "always (stopped(")
    assert editor.ask(lsp.TEXT_DOCUMENT_SIGNATURE_HELP, params).signatures[0].label == (
        "stopped(road_user)"
    )
    params.position = at(BOOK, "always (")
    assert editor.ask(lsp.TEXT_DOCUMENT_SIGNATURE_HELP, params) is None


@pytest.mark.parametrize("tail", ["", " }\n}\n"])
def test_an_example_has_objects_of_its_own(editor, tail):
    """Also while its braces, and those of its rule, are still open."""
    head = BOOK[: BOOK.rindex("}")]
    for typed, expected in (
        ("accept (two: vehicle) { stopped(two) and ", {"stopped(two)", "stopped(o)"}),
        ("accept (two: vehicle) { stopped(two) and stopped(", {"two", "o", "who"}),
        ("accept (two: pedestrian) { stopped(", {"two", "o", "who"}),
    ):
        text = f"{head}  {typed}{tail}"
        found = completed(editor, "objects.rules", text, at(text, typed))
        assert expected <= found.keys(), typed


def test_an_open_rule_has_its_variables(editor):
    text = "rulebook begun\nextends vienna\nhard rule r(v: vehicle) {\n  require stopped(v) and "
    found = completed(editor, "open.rules", text, at(text, "stopped(v) and "))
    assert "stopped(v)" in found
