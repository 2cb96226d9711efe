"""What is said of rules that count, against every small state: with facts, and with subtypes."""

import re
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rulec import analyze, diff
from rulec.analysis.counterexample import counterexample
from rulec.analysis.diff.rule_comparison import compare
from rulec.analysis.lint.conflict_search import Conflict, conflict
from rulec.analysis.lint.redundancy import can_be_kept, can_be_violated, implied_by
from rulec.analysis.lint.rulebook_findings import rulebook_findings
from rulec.analysis.shared_compilation import AnalyzedRule, compile_shared
from rulec.diagnostics import RulecError
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Rule
from rulec.trace import Trace
from rulec.witnesses.undecided import UndecidedError
from support.generators.random_rule_pairs import allows

HEAD = """rulebook counted
type thing
type car is thing
signal p, q, loud(v: thing), slow(v: thing) default false
signal near(v: thing, w: thing) default false
"""

FACTS = (
    "loud(v) implies p",
    "loud(v) implies slow(v)",
    "slow(v) implies not q",
    "not (loud(v) and slow(v))",
    "not (loud(v) and loud(w))",
    "loud(v) or p",
    "p implies q",
    "near(v, w)",
)
CASTS = [{}, *({"a": one} for one in ("thing", "car"))] + [
    {"a": one, "b": other} for one, other in (("thing", "thing"), ("car", "thing"), ("car", "car"))
]

parts = st.sampled_from(["p", "q", "loud(u)", "slow(u)"])
bodies = st.sampled_from(
    [
        *["loud(z)", "not loud(z)", "slow(z)", "loud(z) and slow(z)", "loud(z) and p", "z = u"],
        *["z = u and loud(z)", "z = u implies loud(u)", "loud(z) and not loud(u)"],
    ]
)
kinds = st.sampled_from(["thing", "car"])
counts = st.builds("(some z: {} ({}))".format, kinds, bodies) | st.builds(
    "(count z: {} ({}) {} {})".format,
    kinds,
    bodies,
    st.sampled_from(["<", ">="]),
    st.sampled_from("12"),
)
formulas = st.recursive(
    counts | parts,
    lambda inner: (
        st.builds("not {}".format, inner)
        | st.builds("({} {} {})".format, inner, st.sampled_from(["and", "or", "implies"]), inner)
    ),
    max_leaves=3,
)
facts = st.lists(st.sampled_from(FACTS), max_size=3, unique=True)


def book(laws, facts, kind="thing"):
    """A rulebook of these laws about one object, and the laws compiled."""
    lines = [f"fact {fact}\n" for fact in facts]
    for number, law in enumerate(laws):
        variables = f"(u: {kind})" if re.search(r"\bu\b", law) else ""
        lines.append(f"hard rule r{number} {variables} {{ require {law} }}\n")
    parsed = parse_rulebook(HEAD + "".join(lines))
    (sides,) = compile_shared([parsed], [{rule.name: rule for rule in parsed.rules}])
    return parsed, list(sides.values())


def small_traces(parsed, sides):
    """Every trace of one state that the facts allow, of two objects at most."""
    known = facts_as_rules(parsed, sides)
    for cast in CASTS:
        keys = [("p", ()), ("q", ())]
        keys += [(name, (item,)) for name in ("loud", "slow") for item in cast]
        for values in product([False, True], repeat=len(keys)):
            state = {}
            for (name, items), value in zip(keys, values, strict=True):
                if items:
                    state.setdefault(name, {})[items[0]] = value
                else:
                    state[name] = value
            trace = Trace("t", 1.0, cast, (state,))
            if all(allows(fact, trace) for fact in known):
                yield trace


def facts_as_rules(parsed, sides):
    """Each fact as a rule, for the oracle."""
    return [
        AnalyzedRule(sides[0].rulebook, (), Rule("fact", "hard", fact.variables, fact.formula), 0)
        for fact in parsed.axioms
    ]


def undecided(question, *about):
    """The answer to a question; None if it is undecided."""
    try:
        return question(*about), True
    except UndecidedError:
        return None, False


@settings(max_examples=settings().max_examples // 2)
@given(st.lists(formulas, min_size=2, max_size=2), facts, st.booleans())
def test_nothing_is_said_that_a_small_state_refutes(two, known, is_always):
    how = "always" if is_always else "eventually"
    try:
        parsed, sides = book([f"{how} {law}" for law in two], known)
    except RulecError as problem:
        if {one.code for one in problem.diagnostics} != {"R0409"}:  # facts contradict each other
            raise
        return
    traces = list(small_traces(parsed, sides))
    first, second = ([allows(side, trace) for trace in traces] for side in sides)
    answer, is_known = undecided(can_be_violated, sides[0])
    assert not is_known or answer or all(first)
    has_objects = [bool(trace.objects) for trace in traces]
    answer, is_known = undecided(can_be_kept, sides[0])
    assert not is_known or answer or not any(map(all, zip(first, has_objects, strict=True)))
    answer, is_known = undecided(implied_by, sides[0], sides[1:])
    if answer:
        assert not any(right and not left for left, right in zip(first, second, strict=True))
    relation = compare(*sides).relation
    if relation in ("equal", "laxer"):
        assert not any(right and not left for left, right in zip(first, second, strict=True))
    if relation in ("equal", "stricter"):
        assert not any(left and not right for left, right in zip(first, second, strict=True))
    answer, is_known = undecided(conflict, sides)
    if answer == Conflict(None):
        assert not any(map(all, zip(first, second, has_objects, strict=True)))
    trace, is_known = undecided(counterexample, sides[0], sides[1:])
    if trace is not None:
        assert not allows(sides[0], trace)
        assert allows(sides[1], trace)
        assert all(allows(fact, trace) for fact in facts_as_rules(parsed, sides))


def said(laws, facts=()):
    """What is said of each of the laws: that it can be violated, and that it can be kept."""
    _, sides = book(laws, facts)
    return [
        (undecided(can_be_violated, side)[0], undecided(can_be_kept, side)[0]) for side in sides
    ]


def test_a_fact_about_a_counted_object_binds_a_word_that_no_rule_reads():
    laws = [
        "never (some z: thing (loud(z)))",
        "eventually some z: thing (loud(z))",
        "always ((some z: thing (loud(z))) implies not p)",
    ]
    assert said(laws, ["loud(v) implies p"]) == [(True, True)] * 3
    _, sides = book([laws[1], "eventually (p and not q)"], ["loud(v) implies p"])
    assert conflict(sides) is None
    _, sides = book([laws[0], "always (p or not p)"], ["loud(v) implies p"])
    assert compare(*sides).relation == "stricter"


def test_a_fact_binds_through_other_facts():
    facts = ["loud(v) implies slow(v)", "slow(v) implies p", "p implies q"]
    assert said(["never (some z: thing (loud(z)))"], facts) == [(True, True)]
    never_both = "always (not q and (some z: thing (loud(z))) implies p)"
    assert said([never_both], facts) == [(False, True)]


def test_an_object_of_a_rule_may_be_of_a_type_that_is_counted():
    as_car = "always (every z: car (z = u implies loud(u)))"
    assert said([as_car, "eventually some z: car (z = u)"]) == [(True, True)] * 2
    _, sides = book([as_car, "always (loud(u) or not loud(u))"], [])
    comparison = compare(*sides)
    assert comparison.relation == "stricter"
    assert comparison.first_forbids[0].objects == {"u": "car"}
    assert implied_by(sides[0], sides[1:]) == ()


def test_the_shortest_trace_may_be_about_a_subtype():
    _, sides = book(["never ((not p and next p) or (p and some z: car (z = u)))"], [])
    trace = counterexample(sides[0], [])
    assert (trace.objects, len(trace.states)) == ({"u": "car"}, 1)


def test_rules_may_be_in_conflict_for_objects_of_some_types_only():
    laws = [f"always ((some z: car (z = u)) implies {own})" for own in ("loud(u)", "not loud(u)")]
    parsed, sides = book(laws, [])
    assert conflict(sides) == Conflict(None, {"u": "car"})
    (found,) = rulebook_findings(parsed, [])
    assert found.message == (
        "rules `r0` and `r1` cannot both be kept for objects of exactly these types: `u: car`; "
        "each alone could"
    )


def test_a_fact_about_two_objects_holds_between_counted_ones():
    law = "always (count z: thing (loud(z)) < {})"
    _, sides = book([law.format(2), law.format(3)], ["not (loud(v) and loud(w))"])
    assert compare(*sides).relation == "undecided"
    with pytest.raises(UndecidedError, match="or to facts"):
        can_be_violated(sides[0])
    _, sides = book([law.format(2), law.format(3)], ["near(v, w)"])
    (trace,) = compare(*sides).first_forbids
    assert all(trace.states[0]["near"][one][other] for one, other in [("thing1", "thing2")])


def test_numbers_of_counted_objects_and_of_others_are_not_told_apart():
    head = HEAD + "quantity gap in m default 0\nquantity way(v: thing) in m default 0\n"
    head += "fact way(v) >= 0 m\nhard rule r { require never some z: thing (way(z) < gap) }\n"
    (found,) = rulebook_findings(parse_rulebook(head), [])
    assert found.code == "R0807"


def test_a_witness_says_of_what_type_an_object_is(tmp_path, monkeypatch):
    """That nothing in its states shows."""
    base = HEAD + "hard rule r (u: thing) { require always (every z: car (z = u implies loud(u))) }"
    (tmp_path / "counted.rules").write_text(base)
    law = "always (loud(u) or not loud(u))"
    own = f"rulebook own\nextends counted\noverride rule r (u: thing) {{ require {law} }}"
    (tmp_path / "own.rules").write_text(own)
    monkeypatch.chdir(tmp_path)
    found = analyze("./own.rules")
    (weaker,) = [one for one in found if one.code == "R0806"]
    assert weaker.notes == ("`counted` forbids, for `u: car`: { true }",)
    result = diff("./own.rules", "./counted.rules")
    ((_, _, table),) = result.tables(result.pairs[0])
    assert (table.rows[0].title, table.rows[0].values) == ("type of u", ("car",))
