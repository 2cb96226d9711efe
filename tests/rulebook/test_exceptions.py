"""Exceptions and conditions, read as they are defined: by all ways to cut a word into phases."""

import os
import random
from itertools import combinations_with_replacement, product
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rulec
from rulec.diagnostics import RulecError
from rulec.logic.formula import Atom
from rulec.logic.semantics import holds
from rulec.rulebook.loader import diagnose, parse_rulebook

NAMES = "pqrs"  # of phases and what holds beside them
BESIDE = "uvwxyz"  # of exceptions
ROUNDS = 9 if os.environ.get("RULEC_TEST_PROFILE") == "long" else 1
SCOPES = ["initially", "at start", "throughout", "at some point", "at end"]

# A state is the set of the names that are true in it; a condition is a set of states, and the text
# that says so.
names = st.sampled_from(NAMES)
conditions = st.one_of(
    names.map(lambda one: (one, lambda state: one in state)),
    names.map(lambda one: (f"not {one}", lambda state: one not in state)),
    st.tuples(names, names).map(
        lambda two: (f"({two[0]} and {two[1]})", lambda state: {*two} <= state)
    ),
    st.tuples(names, names).map(
        lambda two: (f"({two[0]} or {two[1]})", lambda state: not state.isdisjoint(two))
    ),
    st.just(("true", lambda _: True)),
    st.just(("false", lambda _: False)),
)
words = st.lists(st.frozensets(names), min_size=1, max_size=7)
bounds = st.one_of(
    st.none(),
    st.tuples(st.integers(0, 3), st.none()),
    st.tuples(st.integers(0, 2), st.integers(2, 4)),
)
phases = st.lists(st.tuples(conditions, bounds), min_size=1, max_size=4)
exceptions = st.lists(st.tuples(conditions, st.sampled_from(SCOPES)), max_size=6)
semantics = st.sampled_from(["stutter", "finite"])


def written(phases):
    """`a then[1 steps .. 3 steps] b`; the last phase has no bound."""
    text = ""
    for (said, _), bound in phases[:-1]:
        within = ""
        if bound is not None:
            low, high = bound
            within = f"[>= {low} steps]" if high is None else f"[{low} steps .. {high} steps]"
        text += f"{said} then{within} "
    return text + phases[-1][0][0]


def formula_of(require, exceptions, kind, when=None):
    unless = " ".join(f"unless {said} {scope}" for (said, _), scope in exceptions)
    condition = f"when {when[0]}" if when else ""
    text = f"""rulebook r semantics {kind} signal {", ".join(NAMES + BESIDE)} default false
    hard rule r {{ require {require} {unless} {condition} }}"""
    return parse_rulebook(text).rules[0].formula


def judged(formula, word, kind):
    letters = [frozenset(Atom(name) for name in state) for state in word]
    return holds(formula, letters, kind)


def lasting(word, kind, further):
    """The word, with its last state repeated as often as can make a difference."""
    return word if kind == "finite" else [*word, *[word[-1]] * further]


def sequences(phases, word):
    """For every way in which the phases occur in the word: at which instants each one begins."""
    for begin in range(len(word)):
        yield from sequences_from(begin, phases, word)


def sequences_from(begin, phases, word):
    """Those whose first phase begins there."""
    ((_, holds_in), bound), *later = phases
    if not later:
        if holds_in(word[begin]):
            yield (begin,)
        return
    low, high = bound or (0, None)
    for end in range(begin + 1, len(word)):
        if not holds_in(word[end - 1]):
            return
        if low <= end - begin and (high is None or end - begin <= high):
            for starts in sequences_from(end, later, word):
                yield (begin, *starts)


def stretch(starts):
    """The instants that a rule guards."""
    if len(starts) == 1:
        return [starts[0]]
    if len(starts) == 2:
        return [starts[1] - 1, starts[1]]
    return list(range(starts[1], starts[-1]))


def exempts(exception, guarded):
    (_, holds_in), scope = exception
    values = [holds_in(state) for state in guarded]
    return {
        "at start": values[0],
        "throughout": all(values),
        "at some point": any(values),
        "at end": values[-1],
    }[scope]


def never_holds(phases, exceptions, word, when=None):
    inside = [one for one in exceptions if one[1] != "initially"]
    if any(holds_in(word[0]) for (_, holds_in), scope in exceptions if scope == "initially"):
        return True
    for starts in sequences(phases, word):
        guarded = [word[at] for at in stretch(starts)]
        in_force = when is None or all(when[1](state) for state in guarded)
        if in_force and not any(exempts(one, guarded) for one in inside):
            return False
    return True


@given(phases, exceptions, words, semantics, st.none() | conditions)
def test_exceptions_of_a_sequence(phases, exceptions, word, kind, when):
    bounded = any(bound for _, bound in phases[:-1])
    if bounded:
        exceptions = [one for one in exceptions if one[1] != "throughout"]
    formula = formula_of(f"never ({written(phases)})", exceptions, kind, when)
    long = lasting(word, kind, sum((bound or (1,))[0] + 1 for _, bound in phases) + 2)
    assert judged(formula, word, kind) == never_holds(phases, exceptions, long, when)


@pytest.mark.parametrize(
    ("sequence", "flat"),
    [
        ("p then q then r", True),
        ("p then (q then r)", True),
        ("p then onward", True),
        ("whole", True),
        ("(p then q) then r", False),
        ("start then r", False),
    ],
)
def test_a_sequence_in_last_place_goes_on_and_any_other_is_one_phase(sequence, flat):
    text = f"""rulebook r semantics finite signal {", ".join(NAMES)} default false
    define onward = q then r
    define start = p then q
    define whole = p then onward
    hard rule r {{ require never ({sequence}) unless s at start }}"""
    formula = parse_rulebook(text).rules[0].formula

    def kept(*word):
        return judged(formula, [frozenset(state) for state in word], "finite")

    # Of three phases the one in the middle is guarded, of two the last state of the first one.
    assert kept("p", "q", "r") != flat
    assert kept("p", "qs", "r")
    assert kept("ps", "q", "r") != flat
    # Where `p then q` is one phase, r follows while it holds: when p ends.
    assert kept("p", "qr") == flat
    assert kept("p", "qrs") == flat
    assert kept("ps", "qr")


def named(name):
    return name, lambda state: name in state


def sequences_with(chance, n_phases, beside="xy", share=0.35):
    """Words in which the phases p, q, r, s occur, with others at random, or are cut off."""
    for lengths in product((1, 2), repeat=n_phases):
        occurring = "".join(name * n for name, n in zip("pqrs", lengths, strict=False))
        for word in (occurring, occurring[: -lengths[-1]]):
            letters = [{one, *(name for name in beside if chance.random() < share)} for one in word]
            if letters:
                yield letters


@pytest.mark.parametrize("scopes", list(combinations_with_replacement(SCOPES, 2)), ids=" and ".join)
@pytest.mark.parametrize("n_phases", [2, 3, 4])
@pytest.mark.parametrize("bound", [None, (2, 2)])
@pytest.mark.parametrize("kind", ["stutter", "finite"])
def test_two_exceptions_of_a_sequence(scopes, n_phases, bound, kind):
    """Every pair of scopes, on words in which the sequence does occur."""
    if bound and "throughout" in scopes:
        return
    some = [(named(name), bound) for name in "pqrs"[:n_phases]]
    exceptions = list(zip((named("x"), named("y")), scopes, strict=True))
    formula = formula_of(f"never ({written(some)})", exceptions, kind)
    chance = random.Random(n_phases)
    for _ in range(ROUNDS):
        for word in sequences_with(chance, n_phases):
            expected = never_holds(some, exceptions, lasting(word, kind, 3 * n_phases))
            assert judged(formula, word, kind) == expected, word


@pytest.mark.parametrize("n_exceptions", [3, 5, 6])
@pytest.mark.parametrize("n_phases", [2, 3, 4])
@pytest.mark.parametrize("kind", ["stutter", "finite"])
def test_each_exception_has_to_hold_throughout_by_itself(n_exceptions, n_phases, kind):
    """Where no single one holds all along, the rule is violated, however they take turns."""
    some = [(named(name), None) for name in "pqrs"[:n_phases]]
    exceptions = [(named(name), "throughout") for name in BESIDE[:n_exceptions]]
    formula = formula_of(f"never ({written(some)})", exceptions, kind)
    chance, verdicts = random.Random(n_phases), set()
    for _ in range(2 * ROUNDS):
        for word in sequences_with(chance, n_phases, BESIDE, share=0.6):
            expected = never_holds(some, exceptions, lasting(word, kind, 3 * n_phases))
            assert judged(formula, word, kind) == expected, word
            verdicts.add(expected)
    assert verdicts == {True, False}


@given(conditions, exceptions, words, semantics, st.none() | conditions)
def test_exceptions_of_what_always_holds(demand, exceptions, word, kind, when):
    text, demanded = demand
    formula = formula_of(f"always {text}", exceptions, kind, when)
    broken = [((f"not {text}", lambda state: not demanded(state)), None)]
    assert judged(formula, word, kind) == never_holds(broken, exceptions, word, when)


@given(conditions, st.lists(conditions, max_size=2), words, semantics, st.none() | conditions)
def test_exceptions_of_any_other_rule_look_at_the_first_state(demand, free, word, kind, when):
    exceptions = [(one, "initially") for one in free]
    formula = formula_of(f"eventually {demand[0]}", exceptions, kind, when)
    exempt = any(holds_in(word[0]) for _, holds_in in free)
    in_force = when is None or when[1](word[0])
    expected = exempt or not in_force or any(demand[1](state) for state in word)
    assert judged(formula, word, kind) == expected


@given(phases.filter(lambda some: len(some) > 1), conditions)
def test_the_scope_that_is_not_written_is_throughout(phases, exempt):
    plain = [(one, None) for one, _ in phases]
    require = f"never ({written(plain)})"
    silent = formula_of(require, [(exempt, "")], "stutter")
    assert silent == formula_of(require, [(exempt, "throughout")], "stutter")


@pytest.mark.parametrize(
    ("require", "unless", "code"),
    [
        ("eventually p", "unless q at end", "R0318"),
        ("p implies never q", "unless q", "R0318"),
        ("never (p then[<= 2 s] q then r)", "unless s", "R0318"),
    ],
)
def test_what_cannot_be_said(require, unless, code):
    with pytest.raises(RulecError) as caught:
        parse_rulebook(f"rulebook r signal p, q, r, s hard rule r {{ require {require} {unless} }}")
    assert [one.code for one in caught.value.diagnostics] == [code]


@pytest.mark.parametrize(
    ("require", "way_out"),
    [("p", "write `require always (…)`"), ("eventually p", "write `initially` at its end")],
)
def test_who_forgot_always_is_told_of_it(require, way_out, tmp_path):
    """Wherever the formula is written: the exception may be another rulebook's."""
    (tmp_path / "a.rules").write_text(
        f"rulebook a signal p, q default false hard rule r {{ require {require} }}"
    )
    path = tmp_path / "b.rules"
    path.write_text("rulebook b extends a override rule r { unless q }")
    with pytest.raises(RulecError) as caught:
        rulec.load_rulebook(path)
    (problem,) = caught.value.diagnostics
    assert problem.help.startswith(way_out)
    (label,) = problem.labels
    assert (Path(label.place.file).name, label.message) == (
        "a.rules",
        "this is what the rule requires",
    )


@pytest.mark.parametrize(
    ("formula", "exception"),
    [("p implies never q", "unless q"), ("never (p then[<= 2 s] q then r)", "unless s")],
)
def test_where_no_scope_fits_two_rules_are_suggested(formula, exception):
    text = f"rulebook x\nsignal p, q, r, s\nhard rule a {{ require {formula} {exception} }}\n"
    (finding,) = diagnose("x.rules", text.encode()).findings
    assert (finding.code, "write two rules" in finding.help) == ("R0318", True)


@pytest.mark.parametrize(
    ("formula", "way_out"),
    [
        ("always p implies q", "write `always (… implies …)`: "),
        ("never p and q", "write `never (… and …)`: "),
    ],
)
def test_who_forgot_parentheses_is_told_of_them(formula, way_out):
    text = f"rulebook x\nsignal p, q, s\nhard rule a {{ require {formula} unless s }}\n"
    (finding,) = diagnose("x.rules", text.encode()).findings
    assert (finding.code, finding.help.startswith(way_out)) == ("R0318", True)
