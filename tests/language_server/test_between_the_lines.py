"""Quick fixes, inlay hints, and lenses above rules."""

import asyncio

import pytest
from lsprotocol import types as lsp

from rulec.language_server import server as server_module
from rulec.language_server.server import language_server
from support.editor import edited, shown

BOOK = """\
rulebook town
law "Act" as of 2020-01-01
use road
traffic right
param most : speed = 50 km/h
signal odd default false
hard rule first(o: vehicle) in safe {
  require always (gap(o) > 0 and gap(o) < 0.01 km implies speed <= most)
  unless odd at some point
  accept "slow" { gap_o = 5 m and speed = 20 km/h }
}
priority safe > calm
"""


def everywhere(editor, kind, name, text, **more):
    lines = text.count("\n")
    return kind(
        text_document=lsp.TextDocumentIdentifier(editor.uri(name)),
        range=lsp.Range(lsp.Position(0, 0), lsp.Position(lines, 0)),
        **more,
    )


def fixes(editor, text, name="mended.rules"):
    """The titles of the quick fixes for a text, and the text with each."""
    editor.open(name, text)
    params = everywhere(
        editor, lsp.CodeActionParams, name, text, context=lsp.CodeActionContext(diagnostics=[])
    )
    found = editor.ask(lsp.TEXT_DOCUMENT_CODE_ACTION, params)
    uri = editor.uri(name)
    return {one.title: edited(text, one.edit.changes[uri]) for one in found}


TOWN = "rulebook town\nsignal fog, slow\nhard rule r {\n  require always (fog implies slow)\n}\n"


@pytest.mark.parametrize(
    ("wrong", "title"),
    [
        (TOWN.replace("implies slow", "implies slwo"), "Write `slow`"),
        (TOWN.replace("always", "alwyas"), "Write `always`"),
        (TOWN.replace("(fog implies slow)", "fog implies slow"), None),
        (TOWN + "hard rule s {\n  require never fog\n", "Put `}` here"),
        (TOWN.replace("fog, slow", "fog, slow, fog"), "Leave out `fog`"),
        (TOWN.replace("implies slow", "implies hazy"), "Declare `signal hazy`"),
        (TOWN.replace("fog implies slow", "fog implies raining"), "Use `road`"),
        (TOWN + "define unused = fog\n", "Leave out the line of `unused`"),
    ],
)
def test_a_quick_fix_mends_what_its_message_is_about(editor, wrong, title):
    found = fixes(editor, wrong)
    assert found, wrong
    if title is not None:
        assert title in found
    for mended in found.values():
        assert not [
            one
            for one in editor.open("mended.rules", mended)
            if one.severity == lsp.DiagnosticSeverity.Error
        ]


def test_either_side_of_traffic_is_offered(editor):
    text = (
        "rulebook sided\nuse road\n"
        "hard rule r(v: vehicle) { require never (beside(v) and near_side_of(v)) }\n"
    )
    found = fixes(editor, text, "sided.rules")
    assert list(found) == ["Say `traffic right`", "Say `traffic left`"]
    assert found["Say `traffic left`"].startswith("rulebook sided\ntraffic left\n")


def test_a_comment_that_allows_nothing_is_left_out(editor):
    text = TOWN.replace("slow\n", "slow  # rulec: allow R0208 because it is used later\n", 1)
    (mended,) = fixes(editor, text, "allowing.rules").values()
    assert mended == TOWN


def test_a_rule_of_the_book_below_is_overridden(editor):
    text = (
        "rulebook again\nextends vienna\nhard rule near_side_passing {\n"
        '  unless stop_sign\n  cite "here"\n}\n'
    )
    title = "Write `override rule near_side_passing`"
    assert fixes(editor, text, "again.rules")[title] == text.replace("hard rule", "override rule")


def hints(editor, name, text):
    editor.open(name, text)
    params = everywhere(editor, lsp.InlayHintParams, name, text)
    lines = text.split("\n")
    for hint in sorted(
        editor.ask(lsp.TEXT_DOCUMENT_INLAY_HINT, params), key=lambda one: one.position, reverse=True
    ):
        line = lines[hint.position.line]
        before, behind = line[: hint.position.character], line[hint.position.character :]
        lines[hint.position.line] = f"{before}«{hint.label}»{behind}"
    return "\n".join(lines)


def test_hints_show_units_and_values(editor):
    text = BOOK.replace("priority safe > calm\n", "").replace(" in safe", "")
    shown_text = hints(editor, "units.rules", text)
    assert "gap(o) > 0« m» and gap(o) < 0.01 km« = 10 m»" in shown_text
    assert "speed <= most« = 50 km/h»" in shown_text


def test_hints_show_how_much_an_operator_speaks_of(editor):
    text = TOWN.replace("always (fog implies slow)", "never fog and slow")
    assert "require «(»never fog«)» and slow" in hints(editor, "narrow.rules", text)
    text = TOWN.replace("always (fog implies slow)", "never fog and never slow")
    assert "«" not in hints(editor, "alike.rules", text)


def test_hints_show_inherited_strength(editor):
    text = (
        "rulebook below\nextends vienna\noverride rule near_side_passing {\n  unless stop_sign\n}\n"
    )
    assert "override« hard» rule near_side_passing« in right_of_way» {" in hints(
        editor, "below.rules", text
    )


CHANGE = "also unless urban_traffic at some point"
LENSES = """\
rulebook lenses
extends vienna
override rule being_overtaken {
  also unless urban_traffic at some point
}
signal urban_traffic default false
soft rule slow_in_town {
  require always (built_up implies speed <= 30 km/h)
  accept "slow" { built_up and speed = 20 km/h }
}
"""


@pytest.fixture
def watched(editor):
    found = editor.open("lenses.rules", LENSES)
    assert [one.message for one in found] == []
    return editor


def lenses(editor):
    params = lsp.CodeLensParams(lsp.TextDocumentIdentifier(editor.uri("lenses.rules")))
    found = editor.ask(lsp.TEXT_DOCUMENT_CODE_LENS, params)
    titles = {}
    for one in found:
        titles.setdefault(shown(LENSES, one.range), []).append(one.command)
    return titles


def execute(editor, command):
    params = lsp.ExecuteCommandParams(command.command, command.arguments)
    return editor.ask(lsp.WORKSPACE_EXECUTE_COMMAND, params)


def test_lenses_run_examples_and_insert_what_is_missing(watched):
    run, english, *others = lenses(watched)["slow_in_town"]
    assert (run.title, english.title, others) == ("run 1 example", "in plain English", [])
    before = watched.refreshed
    assert "1 of 1 examples pass" in execute(watched, run)
    watched.until(lambda: watched.refreshed, lambda now: now > before)
    run, _, insert = lenses(watched)["slow_in_town"]
    assert run.title == "1 example passes"
    assert "untested edges: insert the missing example" in insert.title
    example = execute(watched, insert)
    (edit,) = watched.edits[-1].changes[watched.uri("lenses.rules")]
    assert edit.new_text == f"  {example}\n"
    mended = edited(LENSES, [edit])
    assert watched.change("lenses.rules", mended, 2) == []


@pytest.mark.parametrize(
    ("typed", "inserted"),
    [
        (LENSES.replace("signal", "# above the rule\nsignal"), True),
        (LENSES.replace("built_up implies", "congested implies"), False),
        (LENSES.replace("slow_in_town", "slow"), False),
    ],
)
def test_what_is_missing_is_inserted_where_the_rule_has_moved_to(monkeypatch, typed, inserted):
    server, uri, edits = language_server(), "file:///lenses.rules", []
    real = server_module.example_answer

    def typing_meanwhile(book, rule):
        server.editor.open(uri, typed, 2)
        return real(book, rule)

    async def taken(params):
        edits.extend(params.edit.changes[uri])

    monkeypatch.setattr(server_module, "example_answer", typing_meanwhile)
    monkeypatch.setattr(server_module, "_takes_edits", lambda _: True)
    for name in ("refresh_lenses", "window_show_message"):
        monkeypatch.setattr(server, name, lambda *_: None)
    monkeypatch.setattr(server, "workspace_apply_edit_async", taken)
    server.editor.open(uri, LENSES, 1)
    answer = asyncio.run(server.protocol.fm.commands["rulec.insertExample"](uri, "slow_in_town"))
    end = '"slow" { built_up and speed = 20 km/h }\n'
    assert bool(edits) == inserted
    assert not inserted or edited(typed, edits) == typed.replace(end, f"{end}  {answer}\n")


def test_a_lens_says_a_rule_in_plain_english(watched):
    english = lenses(watched)["slow_in_town"][1]
    assert "30 km/h" in execute(watched, english)
    assert watched.messages[-1].message


def test_a_rule_without_examples_is_not_said_to_be_tested(editor):
    text = "rulebook bare\nsignal p\nhard rule r { require always p }\n"
    assert [one.code for one in editor.open("bare.rules", text)] == []
    command = lsp.Command("", "rulec.insertExample", arguments=[editor.uri("bare.rules"), "r"])
    assert "r has no example" in execute(editor, command)


def test_a_rule_that_is_gone_is_said(watched):
    english = lenses(watched)["slow_in_town"][1]
    english.arguments = [english.arguments[0], "gone"]
    assert execute(watched, english) == "the rulebook has no rule `gone`"
    compare = lenses(watched)["being_overtaken"][2]
    lone = LENSES.replace("extends vienna", "use road").replace("override ", "hard ")
    assert (
        watched.change("lenses.rules", lone.replace(CHANGE, "require never urban_traffic"), 2) == []
    )
    assert execute(watched, compare) == "the rulebook extends no other"


def test_a_lens_compares_a_rule_with_its_parent(watched):
    compare = lenses(watched)["being_overtaken"][2]
    assert compare.title == "stricter or laxer than `vienna`?"
    told = execute(watched, compare)
    assert "lenses compared to vienna" in told
    assert "vienna forbids, lenses allows\n" in told
    assert "urban_traffic" in told.split("vienna forbids, lenses allows")[1]
    assert lenses(watched)["being_overtaken"][2].title == "laxer than `vienna`: see a trace"


def test_a_lens_says_what_commonroad_does_not_tell(watched):
    titles = [one.title for one in lenses(watched)["being_overtaken"]]
    assert "CommonRoad does not tell urban_traffic" in titles
