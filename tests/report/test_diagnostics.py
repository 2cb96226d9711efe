"""How diagnostics look: carets under the right characters, nothing that can drive a terminal."""

import re
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import Diagnostic, Label, RulecError, Source, Span
from rulec.diagnostics.diagnostic import SourceLocation
from rulec.report.findings.diagnostics_text import MAX_WIDTH, Complaints, render_diagnostics


def at(text, part, name="a.rules", occurrence=0):
    start = -1
    for _ in range(occurrence + 1):
        start = text.index(part, start + 1)
    return Span(Source(name, text), start, start + len(part)).place


def show(place, **more):
    return render_diagnostics([Diagnostic("R0202", "message", place, **more)])


def test_everything_at_once():
    text = "one\ntwo three\nfour five\n\n\nsix\n"
    other = at("elsewhere\n", "where", "b.rules")
    error = Diagnostic(
        "R0202",
        "what is wrong",
        at(text, "three"),
        expected="expected something",
        help="the way out",
        labels=(
            Label(at(text, "two"), "first"),
            Label(at(text, "six"), "far"),
            Label(other, "there"),
        ),
        notes=("by the way",),
    )
    warning = Diagnostic("R0207", "a remark", None, severity="warning")
    assert render_diagnostics([error, warning]) == (
        "error[R0202]: what is wrong\n"
        " --> a.rules:2:5\n"
        "  |\n"
        "2 | two three\n"
        "  | --- first\n"
        "  |     ^^^^^ expected something\n"
        "  | ...\n"
        "6 | six\n"
        "  | --- far\n"
        " ::: b.rules:1:5\n"
        "  |\n"
        "1 | elsewhere\n"
        "  |     ----- there\n"
        "  = help: the way out\n"
        "  = note: by the way\n"
        "\n"
        "warning[R0207]: a remark\n"
        "\n"
        "1 error, 1 warning\n"
    )


def test_nothing_is_nothing():
    assert render_diagnostics([]) == ""


def test_the_summary_counts():
    one = Diagnostic("R0202", "m")
    assert render_diagnostics([one, one]).endswith("\n2 errors\n")


def test_a_file_without_a_line():
    assert show(SourceLocation("a.rules")) == "error[R0202]: message\n --> a.rules\n\n1 error\n"


def test_a_row_of_which_only_the_line_is_known_has_no_empty_line():
    lines = show(SourceLocation("cars.csv", 3), expected="expected a number").splitlines()
    assert "  = note: expected a number" in lines
    assert not any("|" in line for line in lines)


@pytest.mark.parametrize("place", [None, SourceLocation("a.rules")])
def test_what_was_expected_is_said_without_a_line_too(place):
    lines = show(place, expected="expected this", help="do that").splitlines()
    assert "  = note: expected this" in lines
    assert lines.index("  = note: expected this") + 1 == lines.index("  = help: do that")


def columns(text):
    wide = sum(2 if unicodedata.east_asian_width(one) in "WF" else 1 for one in text)
    return wide - sum(unicodedata.category(one) in ("Mn", "Me", "Cf") for one in text)


@pytest.mark.parametrize(
    ("line", "part", "before", "under"),
    [
        ("ab cd", "cd", 3, 2),
        ("\tab cd", "cd", 7, 2),
        ("a\tb", "b", 5, 1),
        ("車 信号 p", "信号", 3, 4),
        ("e\u0301 p", "p", 2, 1),
        ("e\u0301 p", "e\u0301", 0, 1),
        ("\x1b[31m p", "p", 9, 1),
        ("a\u202eb", "b", 7, 1),
        ("👍 p", "p", 3, 1),
    ],
)
def test_carets_stand_under_their_characters(line, part, before, under):
    lines = show(at(f"{line}\nnext", part)).splitlines()
    assert lines[4] == f"  | {' ' * before}{'^' * under}"


def test_an_empty_place_gets_one_caret():
    lines = show(Span(Source("a", "abc"), 3, 3).place, expected="more").splitlines()
    assert lines[3:5] == ["1 | abc", "  |    ^ more"]


def test_a_place_over_several_lines_is_underlined_to_the_end_of_the_first():
    assert show(at("one two\nthree", "two\nthree")).splitlines()[4] == "  |     ^^^"


@pytest.mark.parametrize("position", [0, 10, 99, 150, 5_000, 999_990])
def test_long_lines_are_cut_around_the_place(position):
    line = "x" * position + "HERE" + "y" * (1_000_000 - position)
    shown, carets = show(at(line, "HERE")).splitlines()[3:5]
    assert len(shown) <= MAX_WIDTH + len("1 | ……")
    assert "HERE" in shown
    assert carets.index("^") == shown.index("HERE")
    assert carets.count("^") == 4


def test_a_place_beyond_what_is_quoted_of_its_line_is_at_the_end():
    """As where a line ends in characters that its excerpt leaves out."""
    place = SourceLocation("a", 1, 303, end_column=304, excerpt="x" * 300)
    shown, carets = show(place).splitlines()[3:5]
    assert shown.endswith("x")
    assert carets.index("^") == len(shown)


def test_a_label_outside_of_the_cut_is_at_the_edge():
    line = "x" * 500 + "HERE" + "y" * 500 + "THERE"
    text = show(at(line, "HERE"), labels=(Label(at(line, "THERE"), "far"),))
    assert all(len(one) < 120 for one in text.splitlines())


@given(st.text(st.characters(exclude_characters="\n\r")), st.data())
def test_any_line_can_be_shown(line, data):
    start = data.draw(st.integers(0, len(line)))
    end = data.draw(st.integers(start, len(line)))
    text = show(Span(Source("a", line), start, end).place, expected=line, help=line)
    for one in text.splitlines():
        categories = {unicodedata.category(character) for character in one}
        assert categories.isdisjoint({"Cc", "Cs", "Zl", "Zp"})
        assert not set(one) & set("\u202e\u2066\u200f")


@given(st.text("ab \té車e\u0301\x07", max_size=60), st.data())
def test_carets_cover_what_is_meant(line, data):
    start = data.draw(st.integers(0, len(line)))
    end = data.draw(st.integers(start, len(line)))
    lines = show(Span(Source("a", line), start, end).place, expected="!").splitlines()
    carets = next(one for one in lines if "^" in one)
    tabs = line.replace("\t", "    ")
    shown_before = line[:start].replace("\t", "    ").replace("\x07", "\\x07")
    shown = line[start:end].replace("\t", "    ").replace("\x07", "\\x07")
    assert carets.index("^") - 4 == columns(shown_before), tabs
    assert carets.count("^") == max(1, columns(shown))


def test_colour_only_adds_colour():
    text = "signal p q\n"
    one = Diagnostic("R0104", "m", at(text, "q"), "e", "h", (Label(at(text, "p"), "l"),), ("n",))
    plain = render_diagnostics([one])
    colored = render_diagnostics([one], color=True)
    assert "\x1b[1;31merror[R0104]" in colored
    assert re.sub(r"\x1b\[[0-9;]*m", "", colored) == plain
    assert "\x1b" not in plain


def test_a_line_is_as_wide_as_it_is_told():
    line = "x" * 600
    place = SourceLocation("f.rules", 1, 300, 1, 301, line)
    for columns in (40, 100, 160):
        shown = render_diagnostics([Diagnostic("R0202", "m", place)], width=columns + 9)
        assert next(row for row in shown.splitlines() if "xx" in row).count("x") == columns
    assert render_diagnostics([Diagnostic("R0202", "m", place)], width=709).count("…") == 0


def test_of_many_the_same_is_said_once_and_others_are_counted(capsys):
    complaints = Complaints(most=2)
    for message in ("of steps", "of steps", "of types", "of steps", "of sizes"):
        complaints.add(RulecError(Diagnostic("R0507", message)))
    complaints.add(RulecError(Diagnostic("R0503", "of steps")))
    complaints.close()
    lines = capsys.readouterr().err.split("\n")
    assert [line for line in lines if line] == [
        "error[R0507]: of steps",
        "error[R0507]: of types",
        "error[R0503]: of steps",
        "… and 3 more of this kind [R0507]",
    ]
