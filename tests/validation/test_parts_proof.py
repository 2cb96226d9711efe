"""Parts of rules, which triggers are read off, proved against their formulas."""

import json
from dataclasses import replace

import pytest

import rulec
from rulec.automata.bundle.bundle_file import from_json, to_json
from rulec.automata.bundle.cut_machines import stored
from rulec.automata.second_compiler import with_automata
from rulec.validation.file_proof import proofs_of
from support.builders.compiled_files import sealed

BOOK = """rulebook b
signal p, q, r, s default false
hard rule plain { require always (p implies q) unless r unless s initially }
hard rule within { require always (p implies q) when r }
hard rule once_only { require p when r }
hard rule steps { require never (p then q then r) unless s at some point }
hard rule edges { require never (p then q) unless r at start unless s at end }
hard rule through { require never (p then q then r) unless s throughout }
hard rule through_all { require never (p then q then r) unless s throughout unless p throughout }
hard rule long { require never (p then[<= 2 steps] q then r) unless s at end unless r at start }
hard rule two { require never (p then q) unless s throughout unless r throughout unless p at end }
hard rule single { require never (p and q) unless r when s }
hard rule remembered { require always (p implies q) unless once[<= 3 steps] s }
hard rule off { require always (p implies q) unless p or true unless s initially }
"""
NOT_ITS_PARTS = "its parts do not make up its formula"


@pytest.fixture(scope="module")
def compiled():
    return with_automata(rulec.compile_rulebook(rulec.parse_rulebook(BOOK)))


def reasons(data):
    return {proof.rule: proof.because for proof in proofs_of(sealed(data)) if proof.because}


def test_every_scope_is_proved_and_every_trigger_survives(compiled):
    text = to_json(compiled)
    assert reasons(json.loads(text)) == {}
    again = from_json(text.encode(), "b.json")
    assert [rule.trigger for rule in again.rules] == [rule.trigger for rule in compiled.rules]
    assert all(rule.parts is not None for rule in again.rules)


@pytest.mark.parametrize(
    "exempting",
    [
        "when z",
        "unless z at start",
        "unless z at end",
        "unless z at some point",
        "unless z throughout",
        "unless z initially",
        "unless z initially when r",
    ],
)
@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@pytest.mark.parametrize("required", ["never (q then p)", "never (q then once p then q)"])
def test_tables_for_cut_traces_are_those_of_a_sequence_under_way(required, semantics, exempting):
    text = f"""rulebook b
semantics {semantics}
signal p, q, r, z default false
hard rule k {{ require {required} {exempting} }}
"""
    rules = with_automata(rulec.compile_rulebook(rulec.parse_rulebook(text)))
    data = json.loads(to_json(replace(rules, prefixes=stored(rules))))
    assert data["rules"][0]["cut"]["starts"]
    assert reasons(data) == {}


def word(name):
    return {"name": name, "variables": [], "value": None}


CHANGES = {
    "plain": [
        # What triggers the rule: `p` for sure, no longer, or only where r is
        lambda parts: parts.update(required=["always", ["implies", True, word("q")]]),
        lambda parts: parts.update(required=["always", ["implies", word("s"), word("q")]]),
        # The same formula, of which another part is the trigger
        lambda parts: parts.update(required=["always", ["or", word("q"), ["not", word("p")]]]),
        lambda parts: parts.update(required=["never", ["and", ["not", word("q")], word("p")]]),
        lambda parts: parts.update(exemptions=[]),
        lambda parts: parts["exemptions"].pop(),
        lambda parts: parts["exemptions"].append(["at end", True]),
        lambda parts: parts["exemptions"][0].__setitem__(0, "initially"),
        lambda parts: parts["exemptions"][1].__setitem__(0, "at some point"),
        lambda parts: parts["exemptions"][0].__setitem__(0, "sometimes"),
        lambda parts: parts.update(condition=word("q")),
    ],
    "within": [
        lambda parts: parts.update(condition=None),
        lambda parts: parts.update(condition=["not", word("r")]),
    ],
    "once_only": [
        lambda parts: parts.update(condition=None),
        lambda parts: parts.update(condition=word("p")),
        lambda parts: parts.update(required=word("r")),
    ],
    "steps": [
        # Exceptions of everything exempt what is required from meaning anything
        lambda parts: parts.update(
            required=["never", ["then", True, word("q")]],
            exemptions=[["at some point", ["or", word("q"), ["not", word("q")]]]],
        ),
        lambda parts: parts.update(exemptions=[]),
        lambda parts: parts.update(exemptions=[["at some point", word("q")]]),
        lambda parts: parts.update(exemptions=[["initially", word("s")]]),
        lambda parts: parts.update(
            required=["never", ["then", word("q"), ["then", word("q"), word("r")]]]
        ),
    ],
    "edges": [
        lambda parts: parts["exemptions"].pop(),
        lambda parts: parts.update(required=["never", ["then", word("r"), word("q")]]),
    ],
    "through": [
        lambda parts: parts.update(exemptions=[]),
        lambda parts: parts.update(required=["never", ["then", word("p"), word("r")]]),
    ],
    "remembered": [
        lambda parts: parts.update(exemptions=[["at some point", word("p")]]),
        lambda parts: parts.update(required=["always", word("q")]),
    ],
}


@pytest.mark.parametrize("rule", CHANGES)
def test_changed_parts_are_not_proved(rule, compiled):
    for change in CHANGES[rule]:
        data = json.loads(to_json(compiled))
        entry = next(entry for entry in data["rules"] if entry["name"] == rule)
        change(entry["parts"])
        assert list(reasons(data)) == [rule]


def test_a_reason_is_given(compiled):
    data = json.loads(to_json(compiled))
    data["rules"][0]["parts"]["exemptions"] = []
    assert reasons(data) == {"plain": NOT_ITS_PARTS}
    data["rules"][0]["parts"] = {"exemptions": 5}
    assert "does not follow the format" in reasons(data)["plain"]
