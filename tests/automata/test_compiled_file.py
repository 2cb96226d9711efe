"""The compiled rulebook's file: read back as it was, or refused with a reason."""

import json
import random
import subprocess
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rulec
from rulec.automata.bundle.bundle_file import from_json, read_compiled, to_json, write_compiled
from rulec.automata.bundle.cut_machines import StoredPrefixes, stored
from rulec.automata.compiler import compile_rulebook
from rulec.automata.second_compiler import with_automata
from rulec.diagnostics import RulecError
from rulec.logic.formula import (
    Binary,
    BinaryOperator,
    Bound,
    Comparison,
    Count,
    Same,
    Unary,
    UnaryOperator,
)
from rulec.rulebook.rulebook_model import Rulebook
from support import hidden_spot
from support.builders.compiled_files import sealed
from support.builders.rulebooks import P, Q, always, book, eventually, far, implies, near, rule
from support.generators.timed_formulas import TIMED_VOCABULARY, comparison

COMPILED = compile_rulebook(
    book(
        rule("A", always(implies(near("x"), far("y"))), "x: car", "y: thing"),
        rule("B", eventually(P), strength="soft"),
        rule("C", Q),
    )
)
TEXT = to_json(COMPILED)


def timed(name, formula, *variables, **more):
    return replace(rule(name, formula, *variables), **more)


def within(operator, formula, high, unit="s"):
    return Unary(operator, formula, Bound(Fraction(0), Fraction(high), unit))


SLOW = comparison("speed", "<=", Fraction(5, 18))
FEW = comparison("count y: car (near(y))", "<", 3)
CLOSE = comparison("gap(x) - 2 * speed", "!=", 1)
NOT_THIS = Count("y", "car", Binary(BinaryOperator.AND, near("y"), Same("y", "x")))
OTHERS = Comparison(((Fraction(1), NOT_THIS),), "=", Fraction(0), "count others = 0")
NUMBERS = compile_rulebook(
    Rulebook(
        "numbers",
        TIMED_VOCABULARY,
        (
            timed(
                "A",
                always(implies(SLOW, within(UnaryOperator.EVENTUALLY, FEW, 2))),
                level="legal",
                weight=Fraction(1, 3),
                certainty="unverified",
                source="a book",
                book="base",
                step_s=Fraction(1, 2),
            ),
            timed("B", within(UnaryOperator.ONCE, implies(CLOSE, OTHERS), 4, "steps"), "x: thing"),
        ),
        semantics="finite",
        levels=("safety", "legal", "courtesy", "comfort"),
        priorities=frozenset(
            {
                ("safety", "legal"),
                ("safety", "courtesy"),
                ("legal", "courtesy"),
                ("courtesy", "legal"),
            }
        ),
        extends=("base", "paper"),
        at="2026-01-01",
    )
)
NUMBERS_TEXT = to_json(NUMBERS)


def refused(data, code="R0404"):
    with pytest.raises(RulecError) as caught:
        from_json(data if isinstance(data, bytes) else sealed(data), "x.json")
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == code
    assert diagnostic.place.file == "x.json"
    return diagnostic.message


def test_read_back_as_it_was():
    assert from_json(TEXT.encode(), "x.json") == COMPILED
    assert from_json(NUMBERS_TEXT.encode(), "x.json") == NUMBERS
    assert to_json(from_json(NUMBERS_TEXT.encode(), "x.json")) == NUMBERS_TEXT


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
    assert data["version"] == 7
    assert data["spot"].startswith("2.") == hidden_spot.is_there()
    assert [rule["strength"] for rule in data["rules"]] == ["hard", "soft", "hard"]
    assert data["rules"][0]["cite"] == "Art. A"
    assert data["rules"][0]["variables"] == [["x", "car"], ["y", "thing"]]
    assert data["rules"][0]["step_s"] is None
    assert data["rules"][0]["machine"]["reads"][0]["kind"] == "state"


def test_numbers_are_written_exactly():
    data = json.loads(NUMBERS_TEXT)
    first, second = data["rules"]
    assert (first["step_s"], first["weight"], second["step_s"]) == ("1/2", "1/3", None)
    assert first["formula"] == (
        "always (speed <= 5/18 implies eventually[<= 2 s] count y: car (near(y)) < 3)"
    )
    assert first["machine"]["reads"] == [
        {
            "kind": "number",
            "terms": [["1", {"quantity": "speed", "variables": []}]],
            "thresholds": [{"limit": "5/18", "inclusive": False}],
        },
        {
            "kind": "number",
            "terms": first["tree"][1][2][1]["terms"],
            "thresholds": [{"limit": "3", "inclusive": True}],
        },
    ]
    assert data["semantics"] == "finite"
    assert data["priorities"][0] == ["courtesy", "legal"]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "not a compiled rulebook"),
        (b"[]", "not a compiled rulebook"),
        (b"\xff\xfe", "not a compiled rulebook"),
        (b"[" * 100_000, "not a compiled rulebook"),
        (b'{"format": "something else", "version": 1}', "not a compiled rulebook"),
        (b'{"format": "rulec compiled rulebook", "version": 1}', "of version 1"),
        (b'{"format": "rulec compiled rulebook", "version": 8}', "of version 8"),
        (sealed({"format": "rulec compiled rulebook", "version": 7}), "damaged"),
    ],
)
def test_what_is_no_compiled_rulebook_is_refused(data, words):
    assert words in refused(data)


def damage(path, value, text=TEXT):
    data = json.loads(text)
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
        (("rules", 0, "level"), "unheard of"),
        (("rules", 0, "weight"), "0"),
        (("rules", 0, "weight"), "-1/2"),
        (("rules", 0, "weight"), "1/0"),
        (("rules", 0, "weight"), 1),
        (("rules", 0, "certainty"), "hearsay"),
        (("rules", 0, "step_s"), "1/2"),
        (("rules", 0, "machine", "reads", 0, "kind"), "number"),
        (("rules", 0, "book"), None),
        (("levels",), ["a", "a"]),
        (("priorities",), [["a", "b"]]),
        (("extends",), "base"),
        (("more",), 1),
    ],
)
def test_damage_is_noticed(path, value):
    refused(damage(path, value))


QUANTITY = {"quantity": "speed", "variables": []}
COUNT = json.loads(NUMBERS_TEXT)["rules"][0]["tree"][1][2][1]["terms"][0][1]
SPEED_TREE = ("rules", 0, "tree", 1, 1)
COUNT_TREE = ("rules", 0, "tree", 1, 2, 1, "terms", 0, 1)
SAME_TREE = ("rules", 1, "tree", 1, 2, "terms", 0, 1, "body", 2)


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ((*SPEED_TREE, "limit"), "1/4", "does not read the same"),
        ((*SPEED_TREE, "relation"), "<", "does not read the same"),
        ((*SPEED_TREE, "text"), "speed is low", "two different formulas"),
        ((*SPEED_TREE, "terms"), [], "normal form"),
        ((*SPEED_TREE, "terms"), [["2", QUANTITY]], "normal form"),
        ((*SPEED_TREE, "terms"), [["1", QUANTITY], ["1", QUANTITY]], "normal form"),
        ((*SPEED_TREE, "terms"), [["1", QUANTITY], ["1", COUNT]], "normal form"),
        ((*SPEED_TREE, "terms"), [["1", COUNT], ["0", QUANTITY]], "normal form"),
        ((*SPEED_TREE, "terms", 0, 1, "quantity"), "p", "quantity `p`"),
        ((*SPEED_TREE, "terms", 0, 1, "quantity"), "ghost", "quantity `ghost`"),
        ((*SPEED_TREE, "terms", 0, 1, "variables"), ["x"], "quantity `speed(x)`"),
        ((*COUNT_TREE, "type"), "ghost", "type `ghost`"),
        ((*COUNT_TREE, "count"), "z", "`near(y)`"),
        ((*COUNT_TREE, "body"), ["always", True], "at other instants"),
        ((*COUNT_TREE, "body"), ["since", True, True], "at other instants"),
        (("rules", 0, "tree", 1, 1), {"same": ["y", "y"]}, "outside of a count"),
        (("rules", 1, "tree", 1, 1), {"same": ["x", "x"]}, "outside of a count"),
        ((*SAME_TREE, "same"), ["y", "z"], "outside of a count"),
        (("rules", 0, "tree", 1, 2, 2, "to"), "4", "two different formulas"),
        (("rules", 0, "step_s"), None, "wrong step"),
        (("rules", 0, "step_s"), "-1/2", "more than 0"),
        (("rules", 1, "step_s"), "1", "wrong step"),
        (
            ("rules", 0, "machine", "reads", 0, "thresholds", 0, "inclusive"),
            True,
            "not read the same",
        ),
        (("rules", 0, "machine", "reads", 0, "thresholds"), [], "does not fit"),
        (("rules", 0, "machine", "reads", 0, "terms"), 3, "terms"),
        (("priorities",), [["safety", "nothing"]], "unknown level"),
        (("priorities",), [["safety", "legal"], ["legal", "comfort"]], "transitively closed"),
        (("priorities",), [["safety", "legal"], ["safety", "legal"]], "twice"),
        (("levels",), ["safety", "courtesy"], "unknown level"),
    ],
)
def test_damaged_numbers_are_noticed(path, value, words):
    assert words in refused(damage(path, value, NUMBERS_TEXT))


@given(st.data())
def test_a_truncated_file_is_refused(data):
    text = data.draw(st.sampled_from([TEXT, NUMBERS_TEXT])).encode()
    cut = data.draw(st.integers(0, len(text) - 1))
    # The digest's name and its opening quote say what kind of file it is
    begun = text.index(b': "') + 3
    refused(text[:cut], "R0404" if cut < begun else "R0410")


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


PAST = "rulebook past signal p, q hard rule recalled { require always (p implies once q) }"


def test_machines_for_cut_traces_are_in_the_file(tmp_path, monkeypatch):
    compiled = rulec.compile_rulebook(rulec.parse_rulebook(PAST))
    *_, path = write_compiled(with_automata(compiled), tmp_path)
    monkeypatch.setattr("rulec.automata.prefix_machines.answers_to", None)
    again = rulec.compile_rulebook(path)
    assert isinstance(again.prefixes, StoredPrefixes)
    for states in ([(True, False)], [(False, True), (True, False)], [(False, False)]):
        trace = rulec.Trace("t", 1.0, {}, tuple({"p": p, "q": q} for p, q in states), ends="cut")
        assert rulec.verify(trace, again) == rulec.verify(trace, compiled)
    assert to_json(again) == path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("letters", [0]),
        ("following", []),
        ("outcomes", [[3]]),
        ("starts", []),
        ("starts", [99]),
        ("begins", [0]),
    ],
)
def test_damaged_machines_for_cut_traces_are_refused(name, value):
    compiled = rulec.compile_rulebook(rulec.parse_rulebook(PAST))
    data = json.loads(to_json(replace(compiled, prefixes=stored(compiled))))
    data["rules"][0]["cut"][name] = value
    assert "damaged" in refused(data)


def test_machines_for_cut_traces_may_be_lacking_but_not_for_some_rules_alone():
    compiled = rulec.compile_rulebook(rulec.parse_rulebook(PAST))
    lacking = replace(compiled, prefixes=StoredPrefixes({"recalled": None}))
    again = from_json(to_json(lacking).encode(), "past.json")
    trace = rulec.Trace("t", 1.0, {}, ({"p": True, "q": False},), ends="cut")
    (unjudged,) = rulec.verify(trace, again).not_judged
    assert unjudged.rule == "recalled"
    again = from_json(to_json(replace(compiled, prefixes=None)).encode(), "past.json")
    assert again.prefixes is None
    data = json.loads(to_json(replace(compiled, prefixes=stored(compiled))))
    data["rules"].append({**data["rules"][0], "name": "another"})
    del data["rules"][1]["cut"]
    assert "only some of its rules" in refused(data)


@pytest.mark.parametrize("version", [3, 4, 5])
def test_files_without_a_digest_are_refused_with_the_command_that_makes_them_anew(version):
    data = {"format": "rulec compiled rulebook", "version": version, "steps": ["1", "1/2"]}
    with pytest.raises(RulecError) as caught:
        from_json(json.dumps(data).encode(), "my build/old.json")
    (diagnostic,) = caught.value.diagnostics
    assert (diagnostic.code, diagnostic.place.file) == ("R0411", "my build/old.json")
    assert "`rulec compile RULEBOOK --step 1 --step 1/2 -o 'my build'`" in diagnostic.help


def test_a_digest_that_is_not_in_its_place_is_none():
    assert "not in its place" in refused(json.dumps(json.loads(TEXT)).encode(), "R0410")
    assert "not in its place" in refused(TEXT.replace('"sha256"', '"sha257"').encode(), "R0410")


def test_the_digest_is_what_a_shell_finds(tmp_path):
    path = tmp_path / "test.json"
    path.write_text(TEXT)
    found = subprocess.run(
        f"tail -n +3 {path} | sha256sum", shell=True, capture_output=True, text=True, check=True
    )
    assert found.stdout.split()[0] == json.loads(TEXT)["sha256"]


@pytest.mark.parametrize("text", [TEXT, NUMBERS_TEXT], ids=["signals", "numbers"])
@given(st.data())
def test_a_bit_that_is_not_as_it_was_is_refused(text, data):
    changed = bytearray(text.encode())
    place = data.draw(st.integers(0, len(changed) * 8 - 1))
    changed[place // 8] ^= 1 << place % 8
    with pytest.raises(RulecError) as caught:
        from_json(bytes(changed), "x.json")
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code in ("R0404", "R0410")
    assert diagnostic.code == "R0410" or place < 8 * len('{\n "sha256": "')
    assert diagnostic.help


@pytest.mark.long
def test_ten_thousand_bits_in_a_file_of_a_country(tmp_path):
    *_, path = write_compiled(with_automata(rulec.compile_rulebook("gb", step_s=1)), tmp_path)
    whole = path.read_bytes()
    chance = random.Random(7)
    for _ in range(10_000):
        changed = bytearray(whole)
        place = chance.randrange(len(changed) * 8)
        changed[place // 8] ^= 1 << place % 8
        with pytest.raises(RulecError):
            from_json(bytes(changed), str(path))


@pytest.mark.parametrize("name", ["a\x1b[2Jb", "a\nb", "a\u202eb", "a\x85b"])
@pytest.mark.parametrize(
    "path",
    [
        ("name",),
        ("rules", 0, "name"),
        ("rules", 0, "book"),
        ("rules", 0, "variables", 0, 0),
        ("vocabulary", "name"),
        ("vocabulary", "declarations", 0, "name"),
        ("vocabulary", "declarations", 1, "values", 0),
        ("at",),
    ],
)
def test_names_that_a_terminal_would_obey_are_refused(path, name):
    message = refused(damage(path, name))
    assert "not visible" in message
    assert message.isprintable()


def test_a_type_that_a_terminal_would_obey_is_refused():
    assert "not visible" in refused(damage(("vocabulary", "types", "a\x1b[2Jb"), None))
