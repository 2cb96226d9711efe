"""The page for a browser: whole, safe, and fit to be read aloud."""

from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.report.text.html_page import as_html
from rulec.report.text.markdown import Heading, PageTexts, code, escaped, fenced, table, written
from rulec.report.text.page_body import MOST_UNFOLDED
from support.oracles.page_policy import check_policy

VOID = {"meta", "hr", "br"}


class Read(HTMLParser):
    """What is in a page; fails where an element is not closed in its place."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements, self.texts = [], [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs), tuple(self.open)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        assert tag in VOID
        self.handle_starttag(tag, attrs)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)

    def named(self, tag):
        return [(attrs, inside) for name, attrs, inside in self.elements if name == tag]


PAGE = written(
    [
        Heading(1, "A book"),
        Heading(2, "Contents"),
        "- [Rules](#rules)\n  - [r](#r)",
        Heading(2, "Rules"),
        Heading(3, "r"),
        table(["state", "0"], [["speed", "1"], ["light", "2"]]),
        fenced("require always p", "rulec"),
        fenced("-old\n+new", "diff"),
        "- (a) one\n- (b) two",
    ]
)


@pytest.mark.parametrize("depth", [12, 300])
def test_lists_within_lists_are_shown_however_deep(depth):
    nested = "\n".join("  " * k + f"- level {k}" for k in range(depth))
    read = Read(as_html(f"{nested}\n\n# What follows\n", PageTexts("A book", "Contents")))
    assert len(read.named("li")) >= depth
    assert f"level {depth - 1}" in "".join(read.texts)
    assert any("What follows" in text for text in read.texts)


def test_the_contents_are_navigation_and_nothing_else_is():
    read = Read(as_html(PAGE, PageTexts("A book", "Contents")))
    assert len(read.named("nav")) == 1
    inside = ["nav" in inside for _, inside in read.named("li")]
    assert inside == [True, True, False, False]


def test_links_lead_somewhere():
    read = Read(as_html(PAGE, PageTexts("A book", "Contents")))
    names = [attrs["id"] for _, attrs, _ in read.elements if "id" in attrs]
    assert names == ["a-book", "contents", "rules", "r"]
    assert [attrs["href"] for attrs, _ in read.named("a")] == ["#rules", "#r"]


def test_tables_say_what_is_a_header_of_what():
    read = Read(as_html(PAGE, PageTexts("A book", "Contents")))
    assert [attrs["scope"] for attrs, _ in read.named("th")] == ["col", "col", "row", "row"]
    assert len(read.named("td")) == 2
    assert all("div" in inside for _, inside in read.named("table"))


def test_what_is_long_or_below_a_fourth_heading_is_folded():
    rows = [[str(row)] for row in range(MOST_UNFOLDED)]
    blocks = [
        Heading(2, "Short"),
        table(["n"], rows[1:]),
        Heading(2, "Long"),
        table(["n"], rows),
        Heading(3, "Rule"),
        "it says",
        Heading(4, "Formula"),
        fenced("always p", "rulec"),
        Heading(4, "Examples"),
        "- none",
        "---",
        "the end",
    ]
    for is_closed in (True, False):
        read = Read(as_html(written(blocks), PageTexts("A book", is_closed=is_closed)))
        folds = read.named("details")
        assert [attrs for attrs, _ in folds] == 3 * [{} if is_closed else {"open": None}]
        assert [
            attrs["id"]
            for tag in ("h2", "h4")
            for attrs, inside in read.named(tag)
            if "summary" in inside
        ] == ["long", "formula", "examples"]
        assert ["details" in inside for _, inside in read.named("table")] == [False, True]
        assert ["details" in inside for _, inside in read.named("p")] == [False, False]
        assert ["details" in inside for _, inside in read.named("li")] == [True]


def test_the_page_says_that_it_loads_nothing():
    check_policy(as_html(PAGE, PageTexts("A book", "Contents")))


def test_formulas_and_differences_are_coloured_by_class():
    page = as_html(PAGE, PageTexts("A book", "Contents"))
    assert '<span class="k">require</span>' in page
    assert '<span class="gd">-old</span>' in page
    assert '<span class="gi">+new</span>' in page
    assert "style=" not in page


def test_it_is_one_file_for_light_and_dark_and_paper():
    page = as_html(PAGE, PageTexts("A book", "Contents"))
    read = Read(page)
    assert [one for one in read.elements if one[0] in ("script", "link", "img", "iframe")] == []
    for wanted in ("prefers-color-scheme: dark", "@media print", '<html lang="en">'):
        assert wanted in page
    assert "url(" not in page
    assert "@import" not in page


def contrast(one, other):
    """Of two colours such as ``#ffffff``, as WCAG 2.1 has it."""

    def luminance(color):
        parts = [int(color[at : at + 2], 16) / 255 for at in (1, 3, 5)]
        linear = [x / 12.92 if x <= 0.03928 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("theme", ["light", "dark", "print"])
def test_everything_can_be_read(theme):
    page = as_html("", PageTexts("", "Contents"))
    blocks = page.split(":root {")[1:]
    block = dict(zip(("light", "dark", "print"), blocks, strict=True))[theme].split("}")[0]
    colors = {
        name.strip(): value.strip()
        for name, _, value in (line.partition(":") for line in block.split(";"))
        if name.strip().startswith("--")
    }
    pairs = [(text, "--paper") for text in ("--ink", "--faint", "--link")]
    pairs += [(text, "--block") for text in ("--ink", "--word", "--name", "--number")]
    pairs += [("--new", "--new-block"), ("--old", "--old-block")]
    assert min(contrast(colors[text], colors[ground]) for text, ground in pairs) >= 4.5


HOSTILE = st.text(st.sampled_from("<>&\"'`|*_-[]()!\\/ab \u202e"), min_size=1, max_size=20)


@given(HOSTILE, HOSTILE, HOSTILE)
def test_no_text_becomes_a_part_of_the_page(heading, cell, formula):
    page = written(
        [
            Heading(2, f"h{heading}"),
            escaped(cell),
            table(["a", "b"], [[escaped(cell), code(formula)]]),
            fenced(formula, "rulec"),
            "> " + escaped(cell),
        ]
    )
    read = Read(as_html(page, PageTexts(heading, "Contents")))
    known = {"html", "head", "meta", "title", "style", "body", "main", "h2", "p", "div", "table"}
    known |= {"thead", "tbody", "tr", "th", "td", "code", "pre", "span", "blockquote"}
    assert {tag for tag, _, _ in read.elements} <= known


def test_html_in_the_markdown_is_text():
    page = as_html(
        "<script>alert(1)</script>\n\n[x](javascript:alert(1))", PageTexts("<b>", "Contents")
    )
    assert "<script" not in page
    assert "href" not in page
    assert "<title>&lt;b&gt;</title>" in page
