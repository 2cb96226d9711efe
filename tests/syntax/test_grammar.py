"""The grammar file as a whole: what the pieces add up to."""

import re
from pathlib import Path

import pytest
from hypothesis import assume, given
from lark.exceptions import UnexpectedInput

from support.builders.printed_files import print_file
from support.builders.whole_grammar import whole_grammar
from support.generators.syntax_trees import files

PROGRAMS = Path(__file__).parent.parent / "programs"


@given(files)
def test_the_whole_grammar_takes_what_is_printed(file):
    text = print_file(file)
    # Between pieces a line's end matters, which the grammar does not see: a name on the line behind
    # a number could be its unit.
    assume(not re.search(r"\d\s*\n\s*[^\W\d]\w*(\(.*\))? is one of", text))
    whole_grammar().parse(text)


@pytest.mark.parametrize("path", sorted(PROGRAMS.glob("good/*.rules")), ids=lambda path: path.stem)
def test_the_whole_grammar_takes_good_programs(path):
    whole_grammar().parse(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "name",
    [
        *("arrows", "braces_missing", "braces_too_many", "half_formulas", "reserved", "states"),
        *("bounds", "comparisons", "exceptions", "overlays", "provisions", "quantifiers"),
    ],
)
def test_the_whole_grammar_rejects_bad_syntax(name):
    with pytest.raises(UnexpectedInput):
        whole_grammar().parse((PROGRAMS / "bad" / f"{name}.rules").read_text(encoding="utf-8"))
