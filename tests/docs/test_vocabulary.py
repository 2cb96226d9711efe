"""docs/vocabulary.md: what the vocabulary `road` declares, and what its comments say of it."""

import pytest

from rulec.diagnostics import RulecError, Source
from rulec.syntax import decode, parse
from rulec.syntax.tree import ConstantItem, DefineItem, FactItem, ParamItem, PresumedItem
from tools.vocabulary_tables import ROAD, comment_above, vocabulary_tables

MARKS = ConstantItem | PresumedItem | FactItem | ParamItem | DefineItem
ITEMS = [
    item
    for item in parse(decode(ROAD.name, ROAD.read_bytes()))[0].items
    if not isinstance(item, MARKS)
]


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.span.text.split("(")[0])
def test_each_item_says_what_it_means_and_who_supplies_it(item):
    supplier, _, meaning = comment_above(item).partition(": ")
    assert supplier in ("Scene", "Map", "Interpretation")
    assert meaning.endswith(".")


def test_a_row_for_each_word():
    page = vocabulary_tables(
        Source(
            "small.rules",
            "vocabulary small {\n  # Scene: things.\n  type thing\n"
            "  # Map: near\n  # or not.\n  signal near(o: thing), odd default false\n"
            "  # Scene: how\n  # fast.\n  quantity speed in km/h default 2.5\n"
            "  # Map: what is under ego.\n  ground is one of ice, sand\n}\n",
        )
    )
    rows = [line for line in page.splitlines() if line.startswith("| `")]
    assert rows == [
        "| `thing` |  | things. |",
        "| `near(o: thing)` | signal | `false` | near or not. | map |",
        "| `odd` | signal | `false` | near or not. | map |",
        "| `speed` | in km/h | 2.5 | how fast. | scene |",
        "| `ground` | `ice`, `sand` | – | what is under ego. | map |",
    ]


def test_facts_stand_at_the_end():
    page = vocabulary_tables(
        Source(
            "small.rules",
            "vocabulary small {\n  # Map: a.\n  signal a, b default false\n"
            "  fact a\n    implies b\n}\n",
        )
    )
    assert page.endswith("is an error.\n\n- `a implies b`")


def test_a_file_with_mistakes_has_no_page():
    with pytest.raises(RulecError):
        vocabulary_tables(Source("bad.rules", "vocabulary small { signal }"))
