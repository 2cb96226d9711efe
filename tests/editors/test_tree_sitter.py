"""tree-sitter reads every rulebook that ships with the grammar that is made for it."""

import json
import re
import shutil
from pathlib import Path

import pytest

from rulec.syntax.keywords import RESERVED
from tools.language_tokens import spellings
from tools.tree_sitter import highlights, tree_sitter_grammar

ROOT = Path(__file__).resolve().parents[2]
BOOKS = sorted(ROOT.glob("rulebooks/**/*.rules"))
GOOD = sorted(ROOT.glob("tests/programs/good/*.rules"))
WITHOUT_COMMAND = ": `cargo install tree-sitter-cli --no-default-features`"


def test_every_word_of_the_parser_is_spelt_out():
    words = {word for texts in spellings().values() for text in texts for word in text.split()}
    assert words >= RESERVED
    assert {"->", "&&", "&", "[]", "at", "point", "machine-readable"} <= words
    assert spellings()["WEAK_UNTIL"] == ("weak until", "W")


def parts(node):
    """A node of the grammar and all that are in it."""
    yield node
    for inner in [*node.get("members", ()), *([node["content"]] if "content" in node else ())]:
        yield from parts(inner)


def test_every_rule_that_is_named_is_there_and_the_other_way_round():
    rules = json.loads(tree_sitter_grammar())["rules"]
    nodes = [node for rule in rules.values() for node in parts(rule)]
    named = {node["name"] for node in nodes if node["type"] == "SYMBOL"}
    assert named | {"file", "comment"} == rules.keys()
    assert not [node for node in nodes if node.get("members") == []]


def test_every_word_is_highlighted_and_none_that_the_grammar_lacks():
    rules = json.loads(tree_sitter_grammar())["rules"]
    texts = {n["value"] for rule in rules.values() for n in parts(rule) if n["type"] == "STRING"}
    listed = re.findall(r"^\[(.*)\] @", highlights(), re.MULTILINE)
    shown = {text for line in listed for text in json.loads(f"[{line.replace(chr(32), ',')}]")}
    assert shown == texts - {"true", "false"}


@pytest.fixture
def tree_sitter(tmp_path, editors, program, done):
    """tree-sitter's command in a copy of the grammar, its parser generated."""
    command = program("tree-sitter", WITHOUT_COMMAND)
    folder = tmp_path / "tree_sitter"
    shutil.copytree(editors / "tree_sitter", folder)
    home = {"HOME": str(tmp_path), "PATH": "/usr/local/bin:/usr/bin:/bin"}

    def run(verb, *arguments):
        return done(command, verb, *arguments, cwd=folder, env=home)

    run("generate", "src/grammar.json")
    return run


def test_what_the_parser_takes_for_a_space_is_one():
    (spaces, _) = json.loads(tree_sitter_grammar())["extras"]
    for sign in map(chr, range(1 << 16)):
        assert bool(re.fullmatch(spaces["value"], sign)) == bool(re.fullmatch(r"\s", sign))


@pytest.mark.long
@pytest.mark.parametrize("space", ["\u00a0", "\u2009", "\u3000", "\x1c", "\x85"])
def test_tree_sitter_reads_other_spaces(tree_sitter, tmp_path, space):
    text = f"rulebook a\nsignal p\nhard{space}rule r {{ require always p }}\n"
    (tmp_path / "spaces.rules").write_text(text, encoding="utf-8")
    tree_sitter("parse", "-p", ".", "--quiet", tmp_path / "spaces.rules")


@pytest.mark.long
def test_tree_sitter_reads_every_rulebook_that_ships(tree_sitter):
    answer = tree_sitter("parse", "-p", ".", "--quiet", "--stat", *BOOKS, *GOOD)
    assert f"successful parses: {len(BOOKS) + len(GOOD)}; failed parses: 0" in answer


@pytest.mark.long
def test_what_is_called_a_rule_is_one(tree_sitter):
    book = ROOT / "rulebooks" / "de" / "de.rules"
    rules = re.findall(r"^[^#\n]*\brule (\w+)", book.read_text(encoding="utf-8"), re.MULTILINE)
    answer = tree_sitter("query", "-p", ".", "--captures", "queries/highlights.scm", book)
    captured = re.findall(r"- function, .* text: `(\w+)`", answer)
    defined = re.findall(r"^(?:re)?define (\w+)", book.read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(captured) == sorted(rules + defined)
    folds = tree_sitter("query", "-p", ".", "--captures", "queries/folds.scm", book)
    assert folds.count(" - fold, ") >= len(rules)


@pytest.mark.long
@pytest.mark.parametrize(
    "text",
    [
        "rulebook a\nuse paper\nfact always\n",
        "rulebook a\nuse paper\ndefine until = true\n",
        "rulebook a\nuse paper\nhard rule r {\n  require b(v) and\n}\n",
    ],
)
def test_tree_sitter_sees_what_is_wrong(tree_sitter, tmp_path, text):
    (tmp_path / "wrong.rules").write_text(text)
    with pytest.raises(AssertionError, match=r"ERROR|MISSING"):
        tree_sitter("parse", "-p", ".", tmp_path / "wrong.rules")
