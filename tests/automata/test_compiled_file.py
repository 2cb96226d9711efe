"""The compiled rulebook's file: read back as it was, or refused with a reason."""

import json
from dataclasses import replace

import pytest
from books import P, Q, always, book, eventually, far, implies, near, rule
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.compiled_file import from_json, read_compiled, to_json, write_compiled
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import RulecError

COMPILED = compile_rulebook(
    book(
        rule("A", always(implies(near("x"), far("y"))), "x: car", "y: thing"),
        rule("B", eventually(P), strength="soft"),
        rule("C", Q),
    )
)
TEXT = to_json(COMPILED)


def refused(data):
    with pytest.raises(RulecError) as caught:
        from_json(data if isinstance(data, bytes) else json.dumps(data).encode(), "x.json")
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0404"
    assert diagnostic.place.file == "x.json"
    return diagnostic.message


def test_read_back_as_it_was():
    assert from_json(TEXT.encode(), "x.json") == COMPILED


texts = st.text(st.sampled_from('[]{}",:\\ \n\u00a0ab1') | st.characters(codec="utf-8"))


@given(texts, texts)
def test_texts_are_kept_to_the_letter(cite, title):
    rule_with_text = replace(COMPILED.rules[0], cite=cite, says=title)
    compiled = replace(COMPILED, rules=(rule_with_text,), title=title, law=cite)
    assert from_json(to_json(compiled).encode(), "x.json") == compiled


def test_a_row_of_a_table_stands_on_one_line():
    assert (
        f'"letters": {list(COMPILED.rules[1].machine.letters)}'.replace("[", "[ ").replace(
            "]", " ]"
        )
        in TEXT
    )


def test_the_documented_parts_are_there():
    data = json.loads(TEXT)
    assert data["format"] == "rulec compiled rulebook"
    assert data["version"] == 1
    assert data["spot"].startswith("2.")
    assert [rule["strength"] for rule in data["rules"]] == ["hard", "soft", "hard"]
    assert data["rules"][0]["cite"] == "Art. A"
    assert data["rules"][0]["variables"] == [["x", "car"], ["y", "thing"]]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "not a compiled rulebook"),
        (b"[]", "not a compiled rulebook"),
        (b"\xff\xfe", "not a compiled rulebook"),
        (b"[" * 100_000, "not a compiled rulebook"),
        (b'{"format": "something else", "version": 1}', "not a compiled rulebook"),
        (b'{"format": "rulec compiled rulebook", "version": 2}', "of version 2"),
        (b'{"format": "rulec compiled rulebook", "version": 1}', "damaged"),
    ],
)
def test_what_is_no_compiled_rulebook_is_refused(data, words):
    assert words in refused(data)


def damage(path, value):
    data = json.loads(TEXT)
    *parents, last = path
    inside = data
    for key in parents:
        inside = inside[key]
    inside[last] = value
    return data


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("rules", 0, "machine", "letters", 0), 99),
        (("rules", 0, "machine", "letters"), [0]),
        (("rules", 0, "machine", "following", 0, 0), -1),
        (("rules", 0, "machine", "following", 0), [0]),
        (("rules", 0, "machine", "following"), []),
        (("rules", 0, "machine", "accepting", 0), []),
        (("rules", 0, "machine", "accepting"), [[True]]),
        (("rules", 0, "machine", "dead"), None),
        (("rules", 0, "machine", "reads", 0, "name"), "unheard_of"),
        (("rules", 0, "formula"), "always true"),
        (("rules", 0, "tree"), ["always", True]),
        (("rules", 0, "tree"), ["sometimes", True]),
        (("rules", 0, "tree", 0), 3),
        (("rules", 2, "tree"), {"name": "ghost", "variables": [], "value": None}),
        (("rules", 2, "tree"), {"name": "q", "variables": ["x"], "value": None}),
        (("rules", 2, "tree"), {"name": "q", "variables": [], "value": "near"}),
        (("rules", 2, "tree"), {"name": "q", "variables": []}),
        (("rules", 0, "machine", "reads", 0, "variables"), ["z"]),
        (("rules", 0, "machine", "reads", 0, "values"), []),
        (("rules", 0, "machine", "reads", 0, "values"), ["nowhere"]),
        (("rules", 0, "variables", 0, 1), "ghost"),
        (("rules", 0, "variables", 1, 0), "x"),
        (("rules", 0, "strength"), "firm"),
        (("rules", 1, "name"), "A"),
        (("rules", 0, "name"), "../../etc/passwd"),
        (("name",), "a/b"),
        (("vocabulary", "types", "car"), "ghost"),
        (("vocabulary", "types", "thing"), "car"),
        (("vocabulary", "declarations", 0, "parameters"), ["ghost"]),
        (("vocabulary", "declarations", 1, "default"), "blue"),
        (("semantics",), "guesswork"),
        (("more",), 1),
    ],
)
def test_damage_is_noticed(path, value):
    refused(damage(path, value))


@given(st.data())
def test_a_truncated_file_is_refused(data):
    cut = data.draw(st.integers(0, len(TEXT.rstrip()) - 1))
    refused(TEXT.encode()[:cut])


def test_writing_and_reading_files(tmp_path):
    folder = tmp_path / "new" / "folder"
    files = write_compiled(COMPILED, folder)
    assert [file.name for file in files] == ["A.hoa", "B.hoa", "C.hoa", "test.json"]
    assert read_compiled(folder / "test.json") == COMPILED
    assert {file.name for file in folder.iterdir()} == {file.name for file in files}
    assert (folder / "A.hoa").read_text().startswith("HOA: v1\n")


def test_a_folder_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(RulecError) as caught:
        write_compiled(COMPILED, tmp_path / "file" / "inside")
    assert caught.value.diagnostics[0].code == "R0702"


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(RulecError) as caught:
        read_compiled(tmp_path / "missing.json")
    assert caught.value.diagnostics[0].code == "R0701"
