"""Whatever a file looks like: formatting keeps tree and comments, is stable, and fits the width.

``format_source`` asserts some of this itself on every call; here it is asked by other means.
"""

import re
from pathlib import Path
from random import Random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError, Source
from rulec.syntax import parse
from rulec.syntax.formatting import format_source, safe_format
from support.builders.counted_steps import grows_in_proportion
from support.builders.printed_files import print_file
from support.generators.untidy_files import loose_formulas, tree_of, untidy_files

PROGRAMS = Path(__file__).parent.parent / "programs"
TEXTS = [path.read_text(encoding="utf-8") for path in sorted(PROGRAMS.glob("*/*.rules"))]
GOOD = [path.read_text(encoding="utf-8") for path in sorted(PROGRAMS.glob("good/*.rules"))]
FRAGMENTS = st.sampled_from(
    ["#", "# c\n", "\n", "\n\n", " ", "(", ")", "{", "}", ";", '"', "and", "!", "weak ", "[<= 3 s]"]
)
TEXT_OR_COMMENT = re.compile(r'"(?:[^"\\\n]|\\.)*"|(#[^\n]*)')


def formatted(text):
    return format_source(Source("test", text))


def comments_in(text):
    return sorted(found[1].rstrip() for found in TEXT_OR_COMMENT.finditer(text) if found[1])


def code_of(line):
    """A line without its comment, and whether it holds a text."""
    texts = [found[0] for found in TEXT_OR_COMMENT.finditer(line) if not found[1]]
    return TEXT_OR_COMMENT.sub(lambda found: "" if found[1] else found[0], line).rstrip(), texts


@given(st.lists(loose_formulas(), min_size=20, max_size=20))
def test_parentheses_that_group_nothing(formulas):
    rules = [f"hard rule r {{ require {formula} }}\n" for formula in formulas]
    text = f"rulebook test\n{''.join(rules)}"
    tree = tree_of(text)
    assert tree is not None
    result = formatted(text)
    assert tree_of(result) == tree
    assert formatted(result) == result


@given(untidy_files)
def test_tree_comments_and_width(text):
    tree = tree_of(text)
    assume(tree is not None)
    result = formatted(text)
    again, mistakes = parse(Source("again", result))
    assert mistakes == ()
    assert again == tree
    # How each operator is spelled, and every parenthesis that has to be there.
    assert print_file(again, "written") == print_file(tree, "written")
    assert comments_in(result) == comments_in(text)
    assert formatted(result) == result
    assert result.endswith("\n")
    assert not result.endswith("\n\n")
    for line in result.split("\n"):
        assert line == line.rstrip()
        code, texts = code_of(line)
        assert len(code) <= 100 or texts


@given(st.sampled_from(GOOD), st.integers())
def test_indentation_makes_no_difference(text, seed):
    choose = Random(seed)
    indented = re.sub(
        r"^[ \t]*(?=\S)", lambda _: " " * choose.randrange(20), text, flags=re.MULTILINE
    )
    # Columns that an author has made are gone then.
    as_it_is, again = formatted(text), formatted(indented)
    assert again.split() == as_it_is.split()
    assert again.count("\n") == as_it_is.count("\n")


@given(st.sampled_from(TEXTS), st.data())
def test_mutated_files_are_formatted_or_refused(text, data):
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = min(len(text), start + data.draw(st.integers(0, 8)))
        text = text[:start] + data.draw(FRAGMENTS | st.just("")) + text[end:]
    if tree_of(text) is None:
        with pytest.raises(RulecError):
            formatted(text)
    else:
        assert comments_in(formatted(text)) == comments_in(text)


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda _, text: text.replace("and", "or"), "means"),
        (lambda _, text: text.replace("require p", "require"), "means"),
        (lambda _, text: text.replace("and", "&"), "words or signs"),
        (lambda _, text: text.replace("# why", ""), "comments"),
        (lambda _, text: text.replace("# why", "# why not"), "comments"),
        (lambda source, _: f"{source.text}\n", "twice"),
    ],
)
def test_nothing_that_is_something_else_is_given_out(spoil, words, monkeypatch):
    real = safe_format.arranged
    monkeypatch.setattr(safe_format, "arranged", lambda source: spoil(source, real(source)))
    with pytest.raises(safe_format.FormattingError, match=words):
        formatted("rulebook b\nhard rule r { require p and q } # why\n")


@pytest.mark.parametrize(
    ("opening", "closing", "depth"),
    [("(p and ", ")", 99), ("not ", "", 199), ("some x: t (", ")", 199), ("-", "", 60)],
)
def test_a_formula_as_deep_as_may_be(opening, closing, depth):
    formula = opening * depth + "p" + closing * depth
    text = formatted(f"rulebook b\nhard rule r {{ require {formula} }}\n")
    assert max(map(len, text.split("\n"))) <= 100


def test_it_takes_steps_in_proportion():
    rule = "hard rule r (v: car) {{ # c\n require a and b or (c # d\n) accept {{ a;\n b }} }}\n"
    text = rule.replace("{{", "{").replace("}}", "}")
    assert grows_in_proportion(lambda size: formatted("rulebook b\n" + text * size), 6)
