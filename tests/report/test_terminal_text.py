"""Tables and colours of texts for terminals."""

import itertools

import pytest
from click import unstyle

from rulec.report.text.terminal_text import broken, cell_width, fact_lines, styled, table_lines


@pytest.mark.parametrize(
    ("text", "width"), [("ab", 2), ("車", 2), ("e\u0301", 1), ("", 0), ("…", 1)]
)
def test_a_text_is_as_wide_as_it_is_shown(text, width):
    assert cell_width(text) == width
    assert cell_width(styled(text, "bold red", color=True)) == width


def test_columns_are_aligned_whatever_is_in_them():
    rows = [
        ("a", "1", "first"),
        ("車", "1,000", ""),
        (styled("bcd", "bold", color=True), "20", "x"),
    ]
    lines = table_lines(rows, indent="  ", right=(1,))
    assert [unstyle(line) for line in lines] == [
        "  a        1  first",
        "  車   1,000",
        "  bcd     20  x",
    ]


def test_a_line_below_the_head_is_as_long_as_the_widest_row():
    assert table_lines([("a", "b"), ("long", "c")], ruled=(0,)) == ["a     b", "─" * 7, "long  c"]


def test_no_rows_are_no_lines():
    assert table_lines([]) == fact_lines([], 80) == []


def test_long_texts_go_on_below_themselves():
    lines = fact_lines([("name", "one two three four five six"), ("n", " ")], 28)
    assert lines == ["  name  one two three four", "        five six", "  n"]


def test_a_number_stays_with_what_it_counts():
    text = "see StVO § 5 Abs. 3: at least 30 km/h in § 12 and 3 s at state 7"
    for width in range(16, 60):
        lines = broken(text, width, "  ", "    ")
        assert " ".join(map(str.strip, lines)) == text
        for before, after in itertools.pairwise(lines):
            assert not before.endswith(("§", "Abs.", "state")) or not after.strip()[:1].isdigit()
            assert not (before[-1].isdigit() and after.strip().startswith(("km/h", "s ")))
        assert lines[0].startswith("  see")
        assert all(line.startswith("    ") for line in lines[1:])


def test_colour_is_there_only_if_wanted():
    assert styled("a", "green", color=True) == "\x1b[32ma\x1b[0m"
    assert styled("a", "green", color=False) == styled("", "green", color=True) + "a" == "a"
