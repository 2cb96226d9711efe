"""The table of docs/coverage.md: what makes a cell whole, in part or empty, and what counts."""

import pytest

from rulec.diagnostics import Source
from rulec.rulebook.overlay.rulebook_overlay import overlay, own_law
from rulec.syntax import parse
from tools.coverage_table import NOTHING, SILENT, WHOLE, Book, cell, situations, table_of

BASE = """\
rulebook treaty
signal p default false
topics {
  gaps "Gaps" of gap, distance;
  lights "Lamps" of lamps;
  signs "Signs" of sign;
  lanes "Lanes" of lane
}
hard rule gap { cite "Art. 1" require p accept { p } reject { not p } }
hard rule gap_to_horses { cite "Art. 2" require p accept { p } reject { not p } }
hard rule sign { cite "Art. 3" require p }
"""
OWN = """\
rulebook country
extends treaty
law "Road Act"
confirm rule gap { cite "s. 1" }
confirm rule gap_to_horses { cite "s. 2" }
silent on sign because "it has none"
hard rule lamps { cite "s. 3" require p accept { p } }
"""


def book(*texts):
    files = []
    for text in texts:
        file, mistakes = parse(Source("a.rules", text))
        assert mistakes == ()
        files.append(file)
    return Book("country", overlay(files, {}, unsure=False), own_law(files))


@pytest.mark.parametrize(
    ("text", "topic", "asked", "expected"),
    [
        (OWN, "gaps", {"gap", "gap_to_horses"}, WHOLE),
        # A situation on `gap` asks the rule of that name, not the other one.
        (OWN, "gaps", {"gap"}, "◐ s"),
        (OWN.replace('confirm rule gap { cite "s. 1" }\n', ""), "gaps", {"gap"}, "◐ as"),
        # Without that rule it asks those whose names go on from it.
        (
            OWN.replace('confirm rule gap { cite "s. 1" }', 'drop rule gap because "no"'),
            "gaps",
            {"gap"},
            WHOLE,
        ),
        (OWN, "lights", {"lamps"}, "◐ e"),
        (OWN, "lights", set(), "◐ es"),
        (OWN, "signs", set(), SILENT),
        (OWN, "lanes", set(), NOTHING),
        (f'{OWN}silent on lanes because "x"\n', "lanes", set(), SILENT),
    ],
)
def test_a_cell(text, topic, asked, expected):
    assert cell(book(BASE, text), topic, frozenset(asked)) == expected


def test_cells_are_counted():
    page = table_of([book(BASE, OWN)], {"country": frozenset({"gap", "gap_to_horses"})})
    assert (
        "4 topics in 1 books are 4 cells: 1 whole (25 %), 1 in part (25 %), 1 silent with a reason "
        "(25 %), 1 nothing (25 %). Topics on which no book has a rule: 2."
    ) in page
    assert "| Gaps: `gaps` | ● |\n| Lamps: `lights` | ◐ es |\n| Signs: `signs` | – |\n" in page
    assert "| Lanes: `lanes` | · |\n| **whole** | 1 |" in page


def test_only_what_others_have_written_counts(tmp_path):
    case = '[[case]]\nid = "a"\ntopics = ["%s"]\n%s[case.verdicts]\n%s = ["allowed"]\n'
    (tmp_path / "own.toml").write_text(
        case % ("gap", "", "de") + case % ("sign", "independent = true\n", "de")
    )
    (tmp_path / "others.toml").write_text("independent = true\n" + case % ("lamps", "", "fr"))
    (tmp_path / "asked").mkdir()
    drive = '[[situation]]\nindependent = %s\nlaw = { it = "s. 1" }\nviolated = [%s]\n'
    (tmp_path / "asked" / "drives.toml").write_text(
        drive % ("true", '"gap"')
        + drive % ("true", "")
        + 'topics = ["sign"]\n'
        + drive % ("false", '"lamps"')
    )
    assert situations(tmp_path) == {
        "de": frozenset({"sign"}),
        "fr": frozenset({"lamps"}),
        "it": frozenset({"gap", "sign"}),
    }
