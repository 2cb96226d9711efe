"""The parser's tables: of this grammar, dispensable, and run as Lark runs them."""

from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from rulec.diagnostics import Source
from rulec.resources import grammar_file, rulebooks_folder
from rulec.syntax import grammar as at_work
from rulec.syntax import parse_formula, parser_tables
from rulec.syntax.file_pieces import ExamplePieces, RulePieces, span_of
from rulec.syntax.grammar import accepted_after, parse_piece
from rulec.syntax.scanner import scan
from rulec.syntax.split_file import FileSplitter
from rulec.syntax.tree_printer import print_whole
from support.generators.syntax_trees import formulas
from support.oracles.lark_parser import parsed_by_lark
from tools.parser_tables import STARTS, tables_of

GRAMMAR = grammar_file("rulec.lark").read_text(encoding="utf-8")
FILE = grammar_file("rulec.tables.json").read_text(encoding="utf-8")
PROGRAMS = Path(__file__).parents[1] / "programs"
SHIPPED = sorted(rulebooks_folder().rglob("*.rules"))
ALWAYS = ("esterle2019.rules", "vienna.rules", "paper.rules")
FILES = [
    *sorted(PROGRAMS.rglob("*.rules")),
    *[
        pytest.param(file, marks=[] if file.name in ALWAYS else pytest.mark.long)
        for file in SHIPPED
    ],
]


def test_the_tables_are_up_to_date():
    assert tables_of(GRAMMAR) == FILE, ".ci/task regenerate"


def test_the_tables_are_those_in_use():
    assert parser_tables.from_text(FILE, parser_tables.stamp(GRAMMAR)) is not None
    assert parser_tables.from_text(FILE, parser_tables.stamp(f"{GRAMMAR}\n")) is None


def assert_read_as_by_lark(start, text):
    read = parse_piece(start, text, 0, len(text))
    assert read == parsed_by_lark(start, text)


@given(formulas, st.data())
def test_a_formula_and_its_beginnings_are_read_as_by_lark(formula, data):
    text = print_whole(formula)
    assert_read_as_by_lark("formula", text)
    assert_read_as_by_lark("formula", text[: data.draw(st.integers(0, len(text)))])


SPELT = ["hard", "rule", "a", "b(v)", "(", ")", "{", "}", "[", "]", "..", ",", ";", ":", "=", "=="]
SPELT += ["always", "G", "until", "U", "not", "!", "and", "&&", "->", "-->", "1", "2.5", "1-2", "s"]
SPELT += ["km/h", '"x"', '"', "# c\n", "\n", "in", "force", "from", "2020-01-01", "<=", "<", "<=>"]
SPELT += ["at", "start", "at some point", "require", "unless", "true", "is", "one", "of", "on", "é"]


@given(st.sampled_from(STARTS), st.lists(st.sampled_from(SPELT), max_size=12), st.booleans())
@example("clause", ["in", "force", "from", "2020-01-01"], True)
@example("formula", [], True)
@example("formula", ["#", "only a comment"], True)
def test_any_words_are_read_and_refused_as_by_lark(start, words, is_spaced):
    assert_read_as_by_lark(start, (" " if is_spaced else "").join(words))


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_the_pieces_of_a_file_are_read_as_by_lark(path):
    source = Source(str(path), path.read_bytes().decode("utf-8", "replace"))
    tokens = scan(source)
    for piece in pieces_of(FileSplitter(source, tokens).split()):
        span = span_of(source, tokens, piece)
        if piece.kind in STARTS:
            text = source.text[span.start : span.end]
            own = parse_piece(piece.kind, text, 0, len(text))
            assert own == parsed_by_lark(piece.kind, text)
            # Where it stands in its file makes no difference but of place.
            there = parse_piece(piece.kind, source.text, span.start, span.end)
            assert shifted(there, -span.start) == own


def pieces_of(parts):
    for part in parts:
        match part:
            case RulePieces():
                yield part.head
                yield from pieces_of(part.body)
            case ExamplePieces():
                yield part.head
                yield from part.states
            case _:
                yield part


def shifted(node, by):
    match node:
        case at_work.Mismatch(position, accepted):
            return at_work.Mismatch(position + by, accepted)
        case at_work.ParseNode(kind, children, start, end):
            own = tuple([shifted(child, by) for child in children])
            return at_work.ParseNode(kind, own, start + by, end + by)
    return node._replace(start=node.start + by, end=node.end + by)


def test_nothing_may_follow_what_cannot_be_read():
    assert accepted_after("formula", "p until )") == frozenset()
    assert {"NAME", "LPAR", "NOT"} <= accepted_after("formula", "p until ")
    assert "$END" in accepted_after("formula", "p until q")
    assert "$END" not in accepted_after("formula", "p until ")


@pytest.mark.parametrize("content", [None, "", "{", "[]", "{}", '{"made_of": "abc"}'])
def test_tables_of_another_grammar_are_refused(content, tmp_path, monkeypatch):
    def file(name):
        return Path(tmp_path, name)

    file("rulec.lark").write_text(GRAMMAR, encoding="utf-8")
    if content is not None:
        file("rulec.tables.json").write_text(content, encoding="utf-8")
    monkeypatch.setattr(at_work, "grammar_file", file)
    at_work._tables.cache_clear()
    try:
        with pytest.raises((ValueError, OSError), match=r"rulec\.tables\.json"):
            parse_formula("p until q")
    finally:
        at_work._tables.cache_clear()
