"""Markdown in which any text means itself: what is written comes out of a Markdown reader again."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st
from markdown_it import MarkdownIt

from rulec.report.text.markdown import (
    Heading,
    anchors,
    code,
    escaped,
    fenced,
    linked,
    table,
    written,
)
from rulec.report.text.terminal_text import visible

READER = MarkdownIt("commonmark", {"html": False}).enable("table")

SIGNS = st.text(st.sampled_from("a1 .)-+=*_`~#|<>[](){}!&\\\"';:/\u202e\x07é"), max_size=30)
TEXTS = st.one_of(SIGNS, st.text(st.characters(exclude_categories=["Cs", "Zs"]), max_size=30))


def plain(tokens):
    """The text that a reader sees, and whether there is anything but text in it."""
    found = [child for token in tokens if token.type == "inline" for child in token.children]
    kinds = {one.type for one in found}
    return "".join(one.content for one in found), kinds


def same(read, text):
    """White space at either end, and where lines are drawn together, is no part of a text."""
    return read.split() == visible(text).split()


@given(TEXTS)
def test_a_paragraph_means_itself(text):
    tokens = READER.parse(escaped(text))
    assert {one.type for one in tokens} <= {"paragraph_open", "inline", "paragraph_close"}
    read, kinds = plain(tokens)
    assert same(read, text)
    assert kinds <= {"text", "text_special"}


@given(TEXTS)
def test_a_cell_means_itself(text):
    tokens = READER.parse(table(["head"], [[escaped(text)]]))
    cells = [inline for open_, inline in pairwise(tokens) if open_.type == "td_open"]
    (cell,) = cells
    assert same(plain([cell])[0], text)


@given(TEXTS.filter(str.strip))
def test_code_means_itself(text):
    tokens = READER.parse(table(["head"], [[code(text)]]))
    found = [
        child.content
        for token in tokens
        if token.type == "inline"
        for child in token.children
        if child.type == "code_inline"
    ]
    assert [one.split() for one in found] == [visible(text).split()]


@given(st.lists(SIGNS, min_size=1))
def test_lines_of_code_mean_themselves(lines):
    text = "\n".join(visible(one) for one in lines)
    (token,) = READER.parse(fenced(text, "rulec"))
    assert (token.type, token.info) == ("fence", "rulec")
    assert token.content.rstrip("\n") == text.rstrip("\n")


@given(TEXTS.filter(str.strip))
def test_a_heading_means_itself(text):
    opening, inline, _ = READER.parse(written([Heading(2, text)]))
    assert opening.tag == "h2"
    assert same(plain([inline])[0], text)


def test_addresses_are_links():
    (_, inline, _) = READER.parse(linked("see https://example.org/a_b*c and *this*"))
    links = [one.attrs["href"] for one in inline.children if one.type == "link_open"]
    assert links == ["https://example.org/a_b*c"]
    assert plain([inline])[0] == "see https://example.org/a_b*c and *this*"


def test_other_addresses_are_not():
    (_, inline, _) = READER.parse(linked("javascript:alert(1) <https:///> http://"))
    assert "javascript:alert(1)" in plain([inline])[0]
    assert all("javascript" not in one.attrs.get("href", "") for one in inline.children)


def test_anchors_are_those_of_common_viewers():
    headings = ["Rules", "R1 (Article 11.1, 11.6)", "a_b § 4", "Rules", "rules-1", "Rules"]
    assert anchors(headings) == [
        "rules",
        "r1-article-111-116",
        "a_b--4",
        "rules-1",
        "rules-1-1",
        "rules-2",
    ]


@given(st.lists(st.sampled_from(["a", "A", "a-1", "a 1", "A!", ""])))
def test_no_two_anchors_are_the_same(headings):
    found = anchors(headings)
    assert len(set(found)) == len(found) == len(headings)
