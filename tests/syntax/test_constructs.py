"""Every construct, laid out in every sensible way; and with one mistake, which is one error."""

import pytest

from rulec.diagnostics import Source
from rulec.report.findings.diagnostics_text import render_diagnostics
from rulec.syntax import parse, tree
from support.generators.language_constructs import (
    CLAUSES,
    CONFIRMATIONS,
    HEADER,
    HEADS,
    ITEMS,
)

RULE = "hard rule other {\n  require p\n}"


def in_header(text):
    return f"rulebook a\nuse road\n{text}\nuse paper\n{RULE}\n"


def among_items(text):
    return f"rulebook a\nsignal before\n{text}\nsignal behind\n{RULE}\n"


def as_head(text):
    return f"rulebook a\nsignal p\n{text}\n  require p\n  accept {{ p }}\n}}\n{RULE}\n"


def as_confirmation(text):
    return f'rulebook a\nsignal p\n{text}\n  cite "s. 1"\n  accept {{ p }}\n}}\n{RULE}\n'


def as_clause(text):
    required = "" if text.startswith("require") else "  require p\n"
    rule = f'hard rule single {{\n  says "one"\n  {text}\n{required}  reject {{ p }}\n}}'
    return f"rulebook a\n{rule}\n{RULE}\n"


CASES = [
    *((in_header, construct) for construct in HEADER),
    *((among_items, construct) for construct in ITEMS),
    *((as_head, construct) for construct in HEADS),
    *((as_confirmation, construct) for construct in CONFIRMATIONS),
    *((as_clause, construct) for construct in CLAUSES),
]


def read(text):
    return parse(Source("a.rules", text))


def short(value):
    return value.replace("\n", "/")[:40] if isinstance(value, str) else None


RIGHT = [
    (put, construct.right[0], layout) for put, construct in CASES for layout in construct.right
]
WRONG = [(put, wrong) for put, construct in CASES for wrong in construct.wrong]


@pytest.mark.parametrize(("put", "first", "layout"), RIGHT, ids=short)
def test_every_layout_is_the_same_tree(put, first, layout):
    file, mistakes = read(put(layout))
    assert mistakes == (), render_diagnostics(mistakes)
    assert file == read(put(first))[0]


@pytest.mark.parametrize(("put", "wrong"), WRONG, ids=short)
def test_one_mistake_is_one_error_in_its_place(put, wrong):
    text = put(wrong)
    file, mistakes = read(text)
    shown = f"{text}\n{render_diagnostics(mistakes)}"
    assert len(mistakes) == 1, shown
    first = text[: text.index(wrong)].count("\n") + 1
    # What is missing at the end is seen where the next thing begins.
    assert first <= mistakes[0].place.line <= first + wrong.count("\n") + 1, shown
    # What stands around it is read.
    assert file.items[-1] == read(f"rulebook a\n{RULE}\n")[0].items[-1], shown
    if put is among_items:
        signals = [item for item in file.items if isinstance(item, tree.SignalItem)]
        assert [item.signals[0].name.text for item in signals] == ["before", "behind"], shown


@pytest.mark.parametrize(("put", "constructs"), [(in_header, HEADER), (among_items, ITEMS)])
def test_constructs_on_one_line(put, constructs):
    first = [construct.right[0] for construct in constructs]
    file, mistakes = read(put(" ".join(first)))
    assert mistakes == (), render_diagnostics(mistakes)
    assert file == read(put("\n".join(first)))[0]


def test_clauses_on_one_line():
    once = [one for one in CLAUSES if not one.right[0].startswith("require")]
    glued = " ".join(construct.right[0] for construct in once)
    apart = "\n".join(construct.right[0] for construct in once)
    file, mistakes = read(as_clause(glued))
    assert mistakes == (), render_diagnostics(mistakes)
    assert file == read(as_clause(apart))[0]


@pytest.mark.parametrize(
    "text",
    [
        "override rule single {}",
        "override rule single { }",
        "override rule single {\n}",
        "override rule single { unless p throughout }",
        "override rule single (v: vehicle) {\n  unless p\n    throughout\n}",
    ],
)
def test_an_override_may_say_little(text):
    file, mistakes = read(among_items(text))
    assert mistakes == ()
    assert file.items[1].override
    assert file.items[1].complete


@pytest.mark.parametrize("word", ["hard", "soft"])
def test_only_an_override_may_require_nothing(word):
    _, (one,) = read(among_items(f"{word} rule single {{ unless p throughout }}"))
    assert one.code == "R0114"


def test_what_cannot_be_read_leaves_its_names():
    file, _ = read(among_items("define overtakes(v: vehicle) behind(v)"))
    (broken,) = (item for item in file.items if isinstance(item, tree.BrokenItem))
    assert "overtakes" in broken.names
    assert not broken.nameless
    file, _ = read(among_items("param = 3 m"))
    (broken,) = (item for item in file.items if isinstance(item, tree.BrokenItem))
    assert broken.nameless


@pytest.mark.parametrize("line", ["extends 3", "extend vienna", "use 3"])
def test_a_file_that_may_lack_names_is_not_complete(line):
    file, (_,) = read(in_header(line))
    assert not file.complete


def test_a_rule_that_lacks_a_clause_is_not_complete():
    file, (_,) = read(as_clause("unless"))
    assert not file.items[0].complete
