"""Whatever is edited, a document has the tree and the findings that its text has by itself."""

from random import Random

import pytest

from rulec.language_server.workspace.editor_workspace import EditorWorkspace
from rulec.resources import rulebooks_folder
from rulec.rulebook.loader import diagnose
from rulec.syntax import parse
from rulec.syntax.scanner import decode
from support.generators.random_edits import edited

BOOK = """\
# Above.
rulebook small
use paper
title "Small"
priority law > comfort

param near : length = 5 m
option strict = off
signal fog, slow default false
quantity wait in s default 0
type thing
signal at_thing(o: thing) default false
define blind = fog and not slow

# The first.
hard rule first in law {
  cite "Art. 1"
  require always (fog implies slow)
  unless strict at some point
  accept "calm" { not fog }
  reject { fog and not slow }
}

soft rule second(o: thing) in comfort weight 2 {
  says "Wait at a thing."
  require always (at_thing(o) and not blind implies wait > 3 s)
}
topics { ways "Ways" of first, second }
hard rule third {
  require never (at_thing_x and blind)
}
"""


def differing_edits(name, text, number, seed, folder):
    """Texts whose document, edited step by step, says something else than they do by themselves."""
    random, original = Random(seed), text
    path = folder / name
    workspace = EditorWorkspace((folder,))
    for _ in range(number):
        document = workspace.open(path.as_uri(), text)
        checked = workspace.check(document)
        alone = diagnose(str(path), text.encode(), path)
        tree, _ = parse(decode(str(path), text.encode()))
        if checked.findings != alone.findings or checked.resolved.trees.books[-1] != tree:
            yield text
        text = edited(text, original, random) or original


def test_a_small_book(tmp_path):
    assert next(differing_edits("small.rules", BOOK, 60, 1, tmp_path), None) is None


def test_lines_end_as_their_editor_ends_them(tmp_path):
    path = tmp_path / "small.rules"
    hidden = BOOK.replace("# Above.", "# Above\u202e.")
    alone = diagnose(str(path), hidden.encode(), path)
    for ends in ("\r\n", "\r"):
        text = hidden.replace("\n", ends)
        workspace = EditorWorkspace((tmp_path,))
        assert workspace.check(workspace.open(path.as_uri(), text)).findings == alone.findings


def test_what_stands_outside_of_rules_depends_on_the_last_one_however_far_above(tmp_path):
    path = tmp_path / "small.rules"
    signals = "".join(f"signal p{number}\n" for number in range(30))
    without = f"rulebook small\n{signals}\n  require never p1\n"
    workspace = EditorWorkspace((tmp_path,))
    workspace.check(workspace.open(path.as_uri(), without))
    text = without.replace("small\n", "small\nhard rule r { require never p2 }\n")
    checked = workspace.check(workspace.open(path.as_uri(), text))
    alone = diagnose(str(path), text.encode(), path)
    assert checked.findings == alone.findings
    (outside,) = [one for one in alone.findings if one.code == "R0109"]
    assert [label.place.line for label in outside.labels] == [2]


def test_a_mistake_in_an_edited_rule_still_names_its_provision(tmp_path):
    path = tmp_path / "small.rules"
    workspace = EditorWorkspace((tmp_path,))
    workspace.check(workspace.open(path.as_uri(), BOOK))
    edited_rule = BOOK.replace("  require never", '  cite "Art. 3"\n  require never')
    for text in (edited_rule, edited_rule.replace("# Above.", "\n\n")):
        checked = workspace.check(workspace.open(path.as_uri(), text))
        assert checked.findings == diagnose(str(path), text.encode(), path).findings
        (wrong,) = [one for one in checked.findings if "at_thing_x" in one.message]
        assert wrong.notes == ("rule `third` is Art. 3",)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(9))
def test_a_small_book_and_a_thousand_edits(seed, tmp_path):
    assert next(differing_edits("small.rules", BOOK, 1000, seed, tmp_path), None) is None


@pytest.mark.long
@pytest.mark.parametrize("book", ["un-r157", "un-r79", "de", "schemas"])
def test_books_that_ship(book, tmp_path):
    text = (rulebooks_folder() / book / f"{book}.rules").read_text(encoding="utf-8")
    assert next(differing_edits(f"{book}.rules", text, 250, 1, tmp_path), None) is None
