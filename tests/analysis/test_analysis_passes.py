"""The passes that comparisons and findings are made of, one by one."""

from dataclasses import replace
from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.analysis.audit.rulebook_audit import used_declarations
from rulec.analysis.believable_states import declarations_read
from rulec.analysis.counterexample import counterexample
from rulec.analysis.shared_compilation import at_one_step, compile_shared
from rulec.analysis.shared_vocabulary import shared_vocabulary
from rulec.analysis.trace_display import SignalRow, trace_note, trace_table
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Comparison,
    Count,
    QuantityTerm,
    Unary,
    UnaryOperator,
)
from rulec.logic.free_names import names_in
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Axiom, Rule, Rulebook
from rulec.trace import Trace
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.witnesses.undecided import UndecidedError
from support.builders.rulebooks import always, no
from support.generators.random_rule_pairs import (
    ALONE,
    COUNTED,
    VOCABULARY,
    X,
    allows,
    formulas,
    sides,
    states,
)

P = Atom("p")


def book(name, *rules, vocabulary=VOCABULARY, **more):
    return Rulebook(name, vocabulary, rules, **more)


def rule(name, formula, variables=(), **more):
    return Rule(name, "hard", tuple(variables), formula, **more)


class TestSharedCompilation:
    def test_what_is_the_same_law_is_compiled_once(self, monkeypatch):
        from rulec.analysis import shared_compilation

        compiled = []
        original = shared_compilation.build_all

        def counting(rulebook, formulas):
            compiled.append([one.name for one in rulebook.rules])
            return original(rulebook, formulas)

        monkeypatch.setattr(shared_compilation, "build_all", counting)
        first, second = rule("r", P), replace(rule("s", P), strength="soft", cite="§ 2")
        other = rule("t", no(P))
        (ours, theirs) = compile_shared(
            [book("a", first, other), book("b", second)], [{"r": first, "t": other}, {"s": second}]
        )
        assert compiled == [["r", "t"], []]
        assert ours["r"].law == theirs["s"].law != ours["t"].law
        assert ours["r"].rule.machine is theirs["s"].rule.machine
        assert (theirs["s"].rule.name, theirs["s"].rule.strength) == ("s", "soft")
        assert (theirs["s"].rule.cite, theirs["s"].rulebook.name) == ("§ 2", "b")

    @pytest.mark.parametrize(
        "changed",
        [
            {"semantics": "finite"},
            {"axioms": (Axiom((), P),)},
            {"vocabulary": Vocabulary("v", {}, {"p": Signal("p", (), True)})},
        ],
    )
    def test_another_context_is_another_law(self, changed):
        own = rule("r", P)
        books = [book("a", own), replace(book("b", own), **changed)]
        (ours, theirs) = compile_shared(books, [{"r": own}, {"r": own}])
        assert ours["r"].law != theirs["r"].law

    @given(st.lists(st.fractions("1/20", 4, max_denominator=20), min_size=1, max_size=4))
    def test_one_step_divides_those_of_all_rules_with_seconds(self, steps):
        timed = Unary(UnaryOperator.ALWAYS, P, Bound(Fraction(0), Fraction(2), "s"))
        rules = [rule("r", timed, step_s=step) for step in steps]
        untimed = rule("s", P, step_s=Fraction(1, 7))
        found = {one.step_s for one in at_one_step([*rules, untimed], None)}
        (step,) = found
        quotients = [one / step for one in steps]
        assert all(one.denominator == 1 for one in quotients)
        # No larger step divides them all.
        for factor in range(2, 9):
            assert any((one / (step * factor)).denominator != 1 for one in steps)
        assert {one.step_s for one in at_one_step(rules, Fraction(3))} == {Fraction(3)}

    def test_rules_without_seconds_keep_their_steps(self):
        own = rule("s", P, step_s=Fraction(1, 7))
        assert at_one_step([own], None) == [own]


class TestSharedVocabulary:
    FIRST = Vocabulary(
        "first",
        {"thing": ObjectType("thing")},
        {
            "p": Signal("p", (), False),
            "q": Signal("q", (), False),
            "light": Enumeration("light", (), ("red", "green")),
            "mine": Signal("mine"),
        },
    )

    def test_the_words_of_both(self):
        second = Vocabulary(
            "second",
            {"thing": ObjectType("thing"), "car": ObjectType("car", "thing")},
            {
                "p": Signal("p", (), False),
                "q": Signal("q", (), True),
                "light": Enumeration("light", (), ("red", "amber", "green")),
                "yours": Signal("yours"),
            },
        )
        joint = shared_vocabulary(self.FIRST, second)
        assert joint.not_shared == {"mine", "yours"}
        assert joint.unlike == {"light"}
        assert set(joint.vocabulary.types) == {"thing", "car"}
        # Where the defaults differ, a trace has to say the value.
        defaults = {name: one.default for name, one in joint.vocabulary.declarations.items()}
        assert defaults == {"p": False, "q": None, "light": None, "mine": None, "yours": None}

    def test_a_vocabulary_with_itself(self):
        joint = shared_vocabulary(self.FIRST, self.FIRST)
        assert (joint.vocabulary, joint.not_shared, joint.unlike) == (self.FIRST, set(), set())

    def test_types_have_to_be_the_same(self):
        second = Vocabulary(
            "second", {"base": ObjectType("base"), "thing": ObjectType("thing", "base")}, {}
        )
        with pytest.raises(UndecidedError, match="`thing` is a different type"):
            shared_vocabulary(self.FIRST, second)


TRACES = [
    Trace("t", 1.0, {"x": "thing"}, word)
    for length in (1, 2)
    for word in product(list(states({"x": "thing"}, ["p", "place"])), repeat=length)
]


class TestCounterexample:
    @given(st.lists(formulas(ALONE[:3]), min_size=1, max_size=3))
    def test_it_is_a_shortest_trace_that_one_forbids_and_others_allow(self, rules):
        forbidding, *allowing = sides(rules, [X], ["finite"] * len(rules))

        def shows(trace):
            return not allows(forbidding, trace) and all(allows(one, trace) for one in allowing)

        trace = counterexample(forbidding, allowing)
        shortest = next((one for one in TRACES if shows(one)), None)
        if trace is None:
            assert shortest is None
        else:
            assert shows(trace)
            if shortest is not None:
                assert len(trace.states) <= len(shortest.states)

    def test_what_is_given_holds_in_its_states(self):
        (forbidding,) = sides([always(no(P))], [], ["stutter"])
        assert counterexample(forbidding, []).states == ({"p": True},)
        assert counterexample(forbidding, [], (Axiom((), no(P)),)) is None

    def test_words_of_two_vocabularies(self):
        first = parse_rulebook("rulebook a signal p default false hard rule r { require never p }")
        unlike = parse_rulebook("rulebook b quantity p in m hard rule r { require never p < 1 m }")
        (ours, theirs) = compile_shared(
            [first, unlike], [{"r": one.rules[0]} for one in (first, unlike)]
        )
        with pytest.raises(UndecidedError, match="`p` is declared differently in the two"):
            counterexample(ours["r"], [theirs["r"]])

    def test_a_rule_judges_alone_in_the_words_of_another_vocabulary(self):
        own = rule("r", always(no(P)))
        analyzed = compile_shared([book("a", own)], [{"r": own}])[0]["r"]
        defaults = Vocabulary("other", {}, {"p": Signal("p", (), True)})
        silent = Trace("t", 1.0, {}, ({},))
        assert not analyzed.violations(silent, Vocabulary("v", {}, {"p": Signal("p", (), False)}))
        assert [one.rule for one in analyzed.violations(silent, defaults)] == ["r"]

    def test_declarations_that_a_rule_reads(self):
        (counting,) = sides([Binary(BinaryOperator.OR, COUNTED[1], ALONE[3])], [], ["stutter"])
        assert declarations_read(counting.rule) == {"place", "speed"}


STATES = [{"p": True}, {"p": True}, {"place": {"x": "near"}}, {"p": True}]
TRACE = Trace("t", 1.0, {"x": "thing", "y": "thing"}, tuple(STATES))


class TestTraceTable:
    def test_equal_states_beside_each_other_share_a_column(self):
        table = trace_table(TRACE, {"p", "place", "gap", "follows"}, VOCABULARY)
        assert table.columns == ((0, 1), (2, 2), (3, 3))
        assert table.rows == (
            SignalRow("place(x)", "", (None, "near", None)),
            SignalRow("place(y)", "", (None, None, None), True),
            SignalRow("p", "", (True, False, True)),
            # Nothing follows itself.
            SignalRow("follows(x, y)", "", (False, False, False), True),
            SignalRow("follows(y, x)", "", (False, False, False), True),
            SignalRow("gap(x)", "m", (None, None, None), True),
            SignalRow("gap(y)", "m", (None, None, None), True),
        )

    def test_only_names_that_are_asked_for(self):
        assert [row.title for row in trace_table(TRACE, {"p"}, VOCABULARY).rows] == ["p"]


class TestTraceLiterals:
    def test_what_has_its_default_is_not_said(self):
        reading = sides(
            [Binary(BinaryOperator.AND, P, Binary(BinaryOperator.AND, ALONE[1], ALONE[6]))],
            [X],
            ["stutter"],
        )
        said = (
            {"p": True, "speed": 0.0, "gap": {"x": 2.5}},
            {"p": False, "speed": 1.0, "place": {"x": "near"}, "follows": {"x": {"y": True}}},
            {},
        )
        trace = Trace("t", 1.0, {"x": "thing", "y": "thing"}, said)
        assert trace_note("seen", trace, reading) == (
            "seen: (y: thing) { p and gap(x) = 2.5 m; near(x) and speed = 1 m/s; true }",
        )


class TestVocabularyUse:
    COUNT = Count("o", "thing", Atom("place", ("o",), "near"))

    def test_names_in_the_order_of_the_formula(self):
        terms = ((Fraction(1), QuantityTerm("speed")), (Fraction(2), self.COUNT))
        formula = Binary(BinaryOperator.UNTIL, Comparison(terms, "<", Fraction(1)), no(P))
        assert list(names_in(formula)) == ["speed", "place", "p"]
        own = book("a", rule("r", formula), rule("s", P))
        assert used_declarations(own) == {"speed", "place", "p"}
