"""Rules as text for other tools: what Spot reads has the language of the rule's automaton."""

import csv
import json
import re
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rulec
from rulec.automata.second_compiler import with_automata
from rulec.ltl_export.ltl_terms import NUXMV, PRISM, SPOT, TRUE, Term, size_of, text_of
from rulec.ltl_export.rule_terms import fresh_identifier
from support.cases.kinds_of_rules import ALL_KINDS
from support.oracles.installed_spot import spot

SMALL = 1
"""The step in s."""
MOST_PROPOSITIONS = 13
"""Beyond that Spot takes long."""


def rows(folder, name):
    with (folder / f"{name}.csv").open(encoding="utf-8") as file:
        return {row["rule"]: row for row in csv.DictReader(file)}


def is_same_language(row, rule, meanings):
    """None where it would take Spot long."""
    named = {one["formula"]: name for name, one in meanings["propositions"].items()}
    if len(named) + len(meanings["an_instant_ago"]) > MOST_PROPOSITIONS:
        return None
    hoa = re.sub(r'"([^"\n]*)"', lambda text: f'"{named.get(text[1], text[1])}"', rule.hoa)
    automaton = spot.automaton(hoa)
    known = f"({row['facts']}) & ({row['history']})"
    outside = spot.translate(f"{known} & !({row['formula']})", "GeneralizedBuchi", "low")
    inside = spot.translate(f"{known} & ({row['formula']})", "GeneralizedBuchi", "low")
    return not automaton.intersects(outside) and not spot.complement(automaton).intersects(inside)


def compared(reference, folder):
    """The rules that are the same and that are not, and those that were not asked."""
    rulec.write_ltl(reference, folder, SMALL)
    compiled = with_automata(rulec.compile_rulebook(reference, step_s=SMALL))
    table = rows(folder, compiled.name)
    meanings = json.loads((folder / f"{compiled.name}.propositions.json").read_text("utf-8"))
    assert list(table) == [rule.name for rule in compiled.rules]
    answers = {True: [], False: [], None: []}
    for rule in compiled.rules:
        same = is_same_language(table[rule.name], rule, meanings["rules"][rule.name])
        answers[same].append(rule.name)
    return answers


@pytest.mark.parametrize("semantics", ["", "semantics finite"])
def test_all_operators(semantics, tmp_path):
    source = tmp_path / "kinds.rules"
    source.write_text(ALL_KINDS.format(semantics=semantics))
    answers = compared(str(source), tmp_path)
    assert answers == {True: ["future", "past", "both"], False: [], None: []}


def test_the_papers_rules(tmp_path):
    assert compared("esterle2019", tmp_path)[True] == ["R1", "R2", "R3"]


@pytest.mark.long
@pytest.mark.parametrize("book", ["de", "gb", "nl", "vienna", "us-ca", "jp"])
def test_rules_that_ship(book, tmp_path):
    answers = compared(book, tmp_path)
    assert not answers[False]
    assert len(answers[True]) > len(answers[None])


def test_what_is_wrong_is_found(tmp_path):
    rulec.write_ltl("esterle2019", tmp_path, SMALL)
    row = rows(tmp_path, "esterle2019")["R3"]
    meanings = json.loads((tmp_path / "esterle2019.propositions.json").read_text("utf-8"))
    rule = with_automata(rulec.compile_rulebook("esterle2019")).rules[2]
    for wrong in ("G !R_pc", "F !(R_pc & f_p)"):
        changed = {**row, "formula": wrong}
        assert is_same_language(changed, rule, meanings["rules"]["R3"]) is False


TERMS = st.recursive(
    st.sampled_from([Term("a"), Term("b"), TRUE]),
    lambda inner: st.one_of(
        st.tuples(st.sampled_from("!XFG"), inner).map(lambda one: Term(one[0], one[1:])),
        st.tuples(st.sampled_from(["&", "|", "->", "<->", "U", "R"]), inner, inner).map(
            lambda one: Term(one[0], one[1:])
        ),
    ),
    max_leaves=6,
)


@given(TERMS)
def test_every_syntax_says_the_same(term):
    plain = spot.formula(text_of(term, SPOT))
    prism = text_of(term, PRISM)
    assert "->" not in prism
    assert spot.are_equivalent(spot.formula(prism), plain)
    assert spot.formula(text_of(term, NUXMV).replace("TRUE", "true")) == plain
    assert len(text_of(term, PRISM)) <= 3 * size_of(term)


@given(st.lists(st.text(), max_size=6))
def test_names_are_identifiers_of_all_tools_and_their_own(texts):
    taken = set()
    for text in [*texts, "G", "true", "time", "a-b", "a b", "alive", ""]:
        name = fresh_identifier(text, taken)
        assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name, re.ASCII)
        assert name not in taken | {"G", "true", "time", "alive"}
        taken.add(name)


def test_where_it_is_from(tmp_path):
    paths = rulec.write_ltl("esterle2019", tmp_path)
    assert [path.name.partition(".")[2] for path in paths] == [
        "csv",
        "props",
        "smv",
        "propositions.json",
    ]
    document = json.loads(paths[-1].read_text("utf-8"))
    sources = rulec.load_rulebook("esterle2019").sources
    assert [one["sha256"] for one in document["sources"]] == [one.sha256 for one in sources]
    assert sources[0].sha256[:16] in paths[2].read_text("utf-8").splitlines()[0]
    assert document["rules"]["R1"]["propositions"]["b_v"]["formula"] == "b(v)"


def test_a_text_without_end_is_refused(tmp_path):
    with pytest.raises(rulec.RulecError, match="too long") as refused:
        rulec.write_ltl("un-r79", tmp_path, Fraction(1, 10_000))
    assert {one.code for one in refused.value.diagnostics} == {"R0754"}
    assert not list(tmp_path.iterdir())
