"""Whether a rule counts steps: seen in its table, against Spot and against repeating letters."""

from itertools import combinations, product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.alphabet import reads_of
from rulec.automata.compiler import compile_rulebook
from rulec.automata.mealy_monitor import IMPOSSIBLE, stutter_invariant
from rulec.monitoring.uncertainty.known_words import run
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from support.generators.random_formulas import ATOMS, VOCABULARY, formulas
from support.oracles.installed_spot import machine_of, spot, spot_bridge
from support.oracles.past_in_spot import in_spot, spot_automaton

translate = spot_bridge.translate


def machine_for(formula):
    reads = reads_of(formula, VOCABULARY)
    return machine_of(translate(formula, reads), reads)


def one_of(*atoms):
    """That one of these holds at a time, for Spot."""
    several = [f"({in_spot(one)} & {in_spot(other)})" for one, other in combinations(atoms, 2)]
    return f"G(({' | '.join(map(in_spot, atoms))}) & !({' | '.join(several)}))"


KNOWN = f"{one_of(*ATOMS[:3])} & {one_of(*ATOMS[3:5])}"
"""A place is near, far or gone, a light red or green."""


@given(formulas)
def test_what_spot_proves_is_seen_in_the_table(formula):
    """The table speaks of words that end in one letter for ever only, so it may prove more."""
    if spot.is_stutter_invariant(spot_automaton(formula, KNOWN)):
        assert stutter_invariant(machine_for(formula))


@given(formulas, st.data())
def test_repeating_letters_changes_no_verdict(formula, data):
    machine = machine_for(formula)
    symbols = sorted(set(machine.letters) - {IMPOSSIBLE})
    word = data.draw(st.lists(st.sampled_from(symbols), min_size=1, max_size=6))
    times = data.draw(st.lists(st.integers(1, 3), min_size=len(word), max_size=len(word)))
    longer = [symbol for symbol, n in zip(word, times, strict=True) for _ in range(n)]
    if stutter_invariant(machine):
        assert run(machine, longer)[0] == run(machine, word)[0]


def judged_alike(machine, longest):
    """Repeating any one letter of any word up to a length changes no verdict."""
    symbols = sorted(set(machine.letters) - {IMPOSSIBLE})
    return all(
        run(machine, word)[0] == run(machine, (*word[: at + 1], *word[at:]))[0]
        for length in range(1, longest + 1)
        for word in product(symbols, repeat=length)
        for at in range(length)
    )


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("always not (p and q)", True),
        ("eventually always p", True),
        ("p until q", True),
        ("always (p implies next q)", False),
        ("always (p implies eventually q)", True),
        ("next next true", None),
        ("p and next not p and next next p", False),
        ("always (p implies once q)", True),
        ("always (p implies previously q)", False),
        ("always (p implies eventually[<= 3 steps] q)", False),
    ],
)
def test_formulas(formula, expected, semantics):
    if expected is None:
        # There is always a next state, unless the trace is taken as it is.
        expected = semantics == "stutter"
    text = (
        f"rulebook r semantics {semantics} signal p default false signal q default false\n"
        f"hard rule A {{ require {formula} }}"
    )
    (rule,) = compile_rulebook(parse_rulebook(text)).rules
    assert stutter_invariant(rule.machine) is expected
    assert judged_alike(rule.machine, 4) is expected


def test_the_papers_rules_do_not_count_steps():
    rules = compile_rulebook(load_rulebook("esterle2019")).rules
    assert [stutter_invariant(one.machine) for one in rules] == [True, True, True]
