"""The passes of findings about rules, one by one: antecedents, redundancy, conflicts."""

from itertools import combinations, product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.analysis.lint.conflict_findings import conflicts
from rulec.analysis.lint.conflict_search import common_objects, conflict, have_harmless_state
from rulec.analysis.lint.finding_messages import undecided_diagnostic
from rulec.analysis.lint.questions import ComparedRules, Question, RuleAnswers, answers_to
from rulec.analysis.lint.redundancy import (
    MOST_PREMISES,
    can_be_kept,
    can_be_violated,
    implied_by,
    small_premises,
)
from rulec.analysis.lint.related_rules import RelatedRules
from rulec.analysis.shared_compilation import compile_shared
from rulec.analysis.trace_display import trace_note
from rulec.diagnostics import RulecError
from rulec.logic.formula import Atom, Binary, BinaryOperator, Constant, Unary, UnaryOperator
from rulec.logic.printing import formula_text
from rulec.resource_limits import in_force
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Axiom, Rule, Variable
from rulec.rulebook.rules.antecedents import antecedents, has_constant, occurrence
from rulec.trace import Trace
from rulec.witnesses.letter_functions import monitor_function
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.undecided import UndecidedError
from support.builders.rulebooks import always, both, eventually, implies, no
from support.generators.random_rule_pairs import ALONE, COUNTED, VOCABULARY, X, Y, sides

P = Atom("p")
NEAR, FAR = ALONE[1], ALONE[2]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("always (p implies q)", [("implies", "p")]),
        ("always ((p implies q) and (q implies p))", [("implies", "p"), ("implies", "q")]),
        ("always (p implies q) and never (q then p)", [("implies", "p"), ("phase", "q")]),
        ("always not (p then q)", [("phase", "p")]),
        ("never ((p then q) or (q then p))", [("phase", "p"), ("phase", "q")]),
        ("never p when q unless p", [("when", "q"), ("unless", "p")]),
        ("always (p implies q) when q", [("when", "q"), ("implies", "p")]),
        ("eventually (p implies q)", []),
        ("p implies q", []),
        ("always (p or q)", []),
    ],
)
def test_antecedents(text, expected):
    head = "rulebook a signal p, q default false "
    (rule,) = parse_rulebook(f"{head}hard rule r {{ require {text} }}").rules
    found = [(one.kind, formula_text(one.formula)) for one in antecedents(rule)]
    assert found == expected


def test_what_is_switched_off_is_no_antecedent():
    source = "rulebook a signal p, q option o = off hard rule r { require never p unless o and q }"
    (rule,) = parse_rulebook(source).rules
    assert list(antecedents(rule)) == []
    assert has_constant(no(both(P, Constant(True))))
    assert not has_constant(always(implies(P, NEAR)))


def test_an_occurrence_is_a_rule_of_its_own():
    own = Rule("r", "soft", (X,), always(implies(NEAR, P)))
    (one,) = antecedents(own)
    asked = occurrence(own, one, "r 0")
    assert (asked.name, asked.formula, asked.variables) == ("r 0", eventually(NEAR), (X,))


@pytest.mark.parametrize(
    ("formula", "violated", "kept"),
    [
        (Constant(True), False, True),
        (Constant(False), True, False),
        (always(Binary(BinaryOperator.OR, P, no(P))), False, True),
        (eventually(both(NEAR, FAR)), True, False),
        (P, True, True),
    ],
)
def test_what_can_be_violated_and_kept(formula, violated, kept):
    (rule,) = sides([formula], [X], ["stutter"])
    assert (can_be_violated(rule), can_be_kept(rule)) == (violated, kept)


def test_premises_are_as_few_as_can_be():
    rules = [always(no(both(P, NEAR))), always(no(both(P, FAR))), always(no(NEAR)), always(no(P))]
    first, second, third, all_of = sides(rules, [X], ["stutter"] * 4)
    assert implied_by(first, [second, third]) == (third,)
    assert implied_by(first, [second]) == ()
    assert implied_by(first, [all_of, third]) == (all_of,)
    union = always(no(both(P, Binary(BinaryOperator.OR, NEAR, FAR))))
    (joined,) = sides([union], [X], ["stutter"])
    assert set(map(id, implied_by(joined, [first, second]))) == {id(first), id(second)}
    without = implied_by(joined, [second, first, sides([eventually(P)], [X], ["stutter"])[0]])
    assert {id(one) for one in without} == {id(first), id(second)}


def test_premises_speak_of_the_same_types_or_of_no_objects():
    one, *_ = sides([always(NEAR)], [X], ["stutter"])
    alone, *_ = sides([always(P)], [], ["stutter"])
    cars, *_ = sides([always(NEAR)], [Variable("x", "car")], ["stutter"])
    assert small_premises(one, [alone, cars, one]) == [alone, one]
    assert len(small_premises(one, [alone] * (MOST_PREMISES + 2))) == MOST_PREMISES


def are_related(one, other):
    return RelatedRules("ab", {"a": one, "b": other}, "").of("a") == ["b"]


def test_rules_are_related_by_what_they_read_and_by_axioms():
    about_p, about_near = sides([always(P), always(NEAR)], [X], ["stutter"] * 2)
    assert are_related(about_p, about_p)
    assert not are_related(about_p, about_near)
    speed = ALONE[3]
    chain = tuple(Axiom((X,), both(left, right)) for left, right in [(speed, NEAR), (P, speed)])
    about_p, about_near = sides([always(P), always(NEAR)], [X], ["stutter"] * 2, chain)
    assert are_related(about_p, about_near)


def test_rules_that_share_words_are_counted_before_they_are_held_against_each_other():
    rules = sides(
        [always(P), always(NEAR), eventually(P), always(NEAR), always(P)], [X], ["stutter"] * 5
    )
    names = "abcde"
    related = RelatedRules(names, dict(zip(names, rules, strict=True)), "")
    assert list(related.pairs()) == [("a", "c"), ("a", "e"), ("b", "d"), ("c", "e")]
    with in_force(["pairs=3"]), pytest.raises(RulecError, match="R0718"):
        RelatedRules(names, dict(zip(names, rules, strict=True)), "")


kinds = st.lists(st.sampled_from(["thing", "car"]), max_size=2)


@given(st.lists(kinds, max_size=3))
def test_common_objects_are_enough_for_every_rule(rules):
    heads = [[Variable(f"v{n}", kind) for n, kind in enumerate(types)] for types in rules]
    objects = common_objects(heads, VOCABULARY)
    for types in rules:
        fitting = [
            chosen
            for chosen in combinations(objects.values(), len(types))
            if fits(sorted(chosen), sorted(types))
        ]
        assert fitting
    assert len(objects) == max(map(len, rules), default=0)


def fits(kinds, types):
    """Objects of these kinds in some order; `car` is below `thing` and sorts first."""
    return all(kind in (wanted, "car") for kind, wanted in zip(kinds, types, strict=True))


def test_objects_that_nothing_fits_get_a_name_of_their_own():
    heads = [[Variable("x", "thing"), Variable("y", "car")], [Variable("x", "car")] * 1]
    assert common_objects(heads, VOCABULARY) == {"x": "car", "y": "car"}
    assert common_objects([[], [X]], VOCABULARY) == {"x": "thing"}


NEXT_NEAR = Unary(UnaryOperator.NEXT, NEAR)
NEXT_FAR = Unary(UnaryOperator.NEXT, FAR)


@pytest.mark.parametrize(
    ("formulas", "length"),
    [
        ([eventually(P), always(no(P))], 0),
        ([always(implies(P, NEXT_NEAR)), always(implies(P, NEXT_FAR))], 1),
        ([always(implies(P, NEXT_NEAR)), always(implies(P, NEXT_NEAR))], None),
        ([eventually(P), eventually(NEAR)], None),
        # A rule that cannot be kept by itself is in no conflict.
        ([eventually(both(NEAR, FAR)), always(P)], None),
        ([always(implies(P, Unary(UnaryOperator.NEXT, NEXT_NEAR))), always(no(NEAR))], 1),
    ],
)
def test_conflicts_come_as_early_as_they_can(formulas, length):
    clash = conflict(sides(formulas, [X], ["stutter"] * len(formulas)))
    if length is None:
        assert clash is None
    elif length == 0:
        assert clash.trace is None
    else:
        assert len(clash.trace.states) == length


@pytest.mark.parametrize(
    ("formulas", "harmless"),
    [
        # With all at its default, and where that violates one of them.
        ([always(no(P)), always(implies(NEAR, P))], True),
        ([always(P), always(NEAR)], True),
        ([always(P), always(no(P))], False),
        # Whether the next state may be near depends on the one before.
        (
            [
                always(implies(P, NEXT_NEAR)),
                always(implies(no(P), Unary(UnaryOperator.NEXT, no(NEAR)))),
            ],
            False,
        ),
        # What nothing keeps asks nothing of a state.
        ([Constant(False), always(no(P))], True),
    ],
)
def test_harmless_states(formulas, harmless):
    rules = sides(formulas, [X], ["finite"] * len(formulas))
    universe = ObjectUniverse({"x": "car"}, VOCABULARY)
    machines = [rule.rule.machine for rule in rules]
    functions = [monitor_function(machine, {"x": "x"}) for machine in machines]
    assert have_harmless_state(machines, functions, universe) is harmless
    assert not harmless or conflict(rules) is None


def test_a_search_that_takes_too_long_leaves_its_question_open():
    analyzed = sides([always(P), always(implies(NEAR, NEXT_FAR))], [X], ["stutter"] * 2)
    rules = ComparedRules(dict(zip("rs", analyzed, strict=True)))
    with in_force(["search=6"]):
        problem = next(answers_to(rules, Question("kept", ("s",))))
        # The next question, about two states instead of three, has a limit of its own.
        assert next(answers_to(rules, Question("kept", ("r",)))) is True
    assert "more than 6 steps of search" in str(problem)
    assert "`rulec --limit search=NUMBER`" in str(problem)
    assert next(answers_to(rules, Question("kept", ("s",)))) is True


def test_conflicts_are_at_speeds_of_vehicles():
    """At the usual distance, only at 1,801 km/h would the two ask for p and for its opposite."""
    book = parse_rulebook(
        "rulebook r quantity gap in m default 1000 quantity speed in km/h default 0 signal p\n"
        "hard rule a { require always (gap < speed * 2 s implies next p) }\n"
        "hard rule b { require always (gap < speed * 2 s implies next not p) }\n"
    )
    (both,) = compile_shared([book], [{rule.name: rule for rule in book.rules}])
    (state,) = conflict([*both.values()]).trace.states
    assert 1 <= state["gap"] < state["speed"] / 3.6 * 2
    assert state["speed"] <= 250


def test_conflicts_are_about_all_bindings():
    follows = Atom("follows", ("x", "y"))
    # Who is followed does not follow: no two can follow each other both.
    rules = [always(follows), always(implies(follows, no(Atom("follows", ("y", "x")))))]
    assert conflict(sides(rules, [X, Y], ["stutter"] * 2)).trace is None
    assert conflict(sides([rules[1], always(P)], [X, Y], ["stutter"] * 2)) is None


def findings_of(formulas):
    names = "rstuv"[: len(formulas)]
    analyzed = dict(zip(names, sides(formulas, [X], ["stutter"] * len(formulas)), strict=True))
    analyzed = {
        name: type(one)(one.rulebook, one.axioms, renamed(one.rule, name), one.law)
        for name, one in analyzed.items()
    }
    rules = {
        name: Rule(name, "hard", (X,), formula)
        for name, formula in zip(names, formulas, strict=True)
    }
    answers = RuleAnswers(ComparedRules(analyzed))
    related = RelatedRules(names, analyzed, "")
    return [(one.code, one.message) for one in conflicts(names, analyzed, rules, answers, related)]


def renamed(rule, name):
    from dataclasses import replace

    return replace(rule, name=name)


def test_pairs_come_first_and_groups_hold_no_such_pair():
    pair = [eventually(P), always(no(P)), always(NEAR)]
    ((code, message),) = findings_of(pair)
    assert code == "R0804"
    assert message.startswith("rules `r` and `s` cannot both be kept at all")
    near_or_far = always(Binary(BinaryOperator.OR, NEAR, FAR))
    group = [near_or_far, always(no(NEAR)), always(no(FAR)), always(implies(P, P))]
    ((_, message),) = findings_of(group)
    assert message.startswith("rules `r`, `s` and `t` cannot all be kept at all")


def test_a_group_is_left_with_the_rules_that_its_conflict_needs():
    near_or_far = always(Binary(BinaryOperator.OR, NEAR, FAR))
    needless = [always(implies(NEAR, P)), always(implies(FAR, P))]
    group = [needless[0], near_or_far, always(no(NEAR)), needless[1], always(no(FAR))]
    ((_, message),) = findings_of(group)
    assert message.startswith("rules `s`, `t` and `v` cannot all be kept at all")


def test_notes_are_in_the_words_of_the_rules():
    (rule,) = sides([always(NEAR)], [X], ["stutter"])
    trace = Trace("t", 1.0, {"x": "thing"}, ({"p": True, "place": {"x": "far"}},))
    assert trace_note("seen", trace, [rule]) == ("seen: { far(x) }",)


def test_what_is_left_open_is_a_warning():
    own = Rule("r", "hard", (), P)
    diagnostic = undecided_diagnostic(own, "it can be kept", UndecidedError("it is too large"))
    assert (diagnostic.code, diagnostic.severity) == ("R0807", "warning")
    assert diagnostic.message == ("undecided for rule `r` whether it can be kept: it is too large")


def test_counts_are_asked_about_at_all_sizes():
    for formula, other in product(COUNTED[1:3], repeat=2):
        one, premise = sides([always(formula), always(other)], [], ["stutter"] * 2)
        assert bool(implied_by(one, [premise])) is (COUNTED.index(formula) <= COUNTED.index(other))


def test_premises_are_left_out_where_automata_grow(monkeypatch):
    one, *_ = sides([eventually(NEAR)], [X], ["stutter"])
    monkeypatch.setattr("rulec.analysis.lint.redundancy.MOST_JOINT_STATES", 1)
    assert small_premises(one, [one]) == []
