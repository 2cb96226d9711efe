"""What pages leave to the building of the site: a place for each part, and a part in each place."""

import re
from pathlib import Path

import pytest

from rulec.report.findings.code_registry import all_codes
from rulec.rulebook.loader import load_vocabulary

DOCS = Path(__file__).resolve().parents[2] / "docs"


def filled(built_parts, name):
    return built_parts.filled((DOCS / f"{name}.md").read_text(encoding="utf-8"))


def test_each_part_has_one_place(built_parts):
    texts = (page.read_text(encoding="utf-8") for page in DOCS.glob("*.md"))
    assert sorted(name for text in texts for name in built_parts.PLACE.findall(text)) == sorted(
        built_parts.PARTS
    )


def test_every_code_is_listed(built_parts):
    page = filled(built_parts, "codes")
    assert all(f"\n### {code.code}: {code.title}\n" in page for code in all_codes().values())


@pytest.mark.parametrize("name", ["vocabulary", "format_words"])
def test_every_word_is_listed(built_parts, name):
    page = filled(built_parts, name)
    words = load_vocabulary("road").declarations
    assert [word for word in words if f"\n| `{word}`" not in page.replace("(", "`")] == []
    assert "<!--" not in page


def test_every_case_that_was_looked_up_is_counted(built_parts):
    """A draw has as many cases as were judged, without those that are left out."""
    page = filled(built_parts, "looked_up")
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in page.partition("## The draws")[2].splitlines()
        if re.match(r"\| \d", line)
    ]
    judged = {row[0]: sum(map(int, row[3:])) for row in rows if len(row) == 6}
    left_out = {row[0]: int(row[1]) for row in rows if len(row) == 5}
    assert all(int(row[1]) == sum(map(int, row[2:])) for row in rows if len(row) == 5)
    sections = page.split("\n### Draw ")[1:]
    shown = {part.partition("\n")[0]: part.count("\n| ") - 2 for part in sections}
    assert len(shown) == 11
    for draw, cases in shown.items():
        drawn = sum(judged[one] for one in draw.split(", "))
        assert cases + left_out.get(draw.replace(",", " and"), 0) == drawn, draw
