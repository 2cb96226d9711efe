"""The passes of comparisons, one by one: reasons, matrices, pairs of rulebooks."""

from dataclasses import replace
from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rulec.analysis.counterexample import Contest, counterexample
from rulec.analysis.diff.comparison_matrix import CONVERSE, growing_matrices
from rulec.analysis.diff.rule_comparison import (
    common_types,
    compare,
    diverse_witnesses,
    non_default_names,
    relation_of,
)
from rulec.analysis.diff.rulebook_comparison import (
    diff_rulebooks,
    rules_matching,
    setting_pairs,
    with_distinct_names,
)
from rulec.analysis.lineage.rule_lineage import (
    BookHeader,
    BookLineage,
    ConstantHistory,
    ConstantValue,
    LineageStep,
    RuleHistory,
)
from rulec.analysis.shared_compilation import compile_shared
from rulec.analysis.stated_axioms import said_as_usual
from rulec.diagnostics import RulecError
from rulec.logic.formula import Atom, Binary, BinaryOperator
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.trace import Trace
from rulec.witnesses.object_universe import Itself
from rulec.witnesses.undecided import UndecidedError
from support.builders.rulebooks import always, no
from support.generators.random_rule_pairs import (
    ALONE,
    COUNTED,
    PAIRED,
    VOCABULARY,
    X,
    Y,
    allows,
    formulas,
    sides,
)

P = Atom("p")


def either(*atoms):
    whole = atoms[0]
    for one in atoms[1:]:
        whole = Binary(BinaryOperator.OR, whole, one)
    return whole


LEADS = Axiom((X, Y), Binary(BinaryOperator.IMPLIES, Atom("follows", ("x", "y")), P))
"""Ties `p` to `follows`."""


class TestAsUsual:
    @given(
        st.sampled_from([ALONE, PAIRED, [*ALONE, *COUNTED]]).flatmap(
            lambda atoms: st.tuples(formulas(atoms), formulas(atoms))
        ),
        st.sampled_from([(), (LEADS,)]),
        st.lists(st.sets(st.sampled_from(["p", "follows", "speed"]), min_size=1), max_size=4),
    )
    def test_it_is_what_a_search_with_these_facts_gives(self, rules, axioms, asked):
        forbidding, allowing = sides(rules, [X, Y], axioms=axioms)
        try:
            contest = Contest(forbidding, [allowing])
        except UndecidedError:
            return
        for names in asked:
            declared = VOCABULARY.declarations
            facts = [said_as_usual(name, Itself(declared[name])) for name in sorted(names)]
            try:
                expected = counterexample(forbidding, [allowing], facts)
            except UndecidedError:
                continue
            assert contest.trace_as_usual(names) == expected

    def test_a_default_that_only_one_of_them_has(self):
        texts = [
            f"rulebook {name} signal p default {default} signal q default false"
            f" hard rule r {{ require never ({rule}) }}"
            for name, default, rule in (("a", "false", "q and not p"), ("b", "true", "q and p"))
        ]
        books = [parse_rulebook(text) for text in texts]
        ours, theirs = compile_shared(books, [{"r": book.rules[0]} for book in books])
        contest = Contest(ours["r"], [theirs["r"]])
        assert contest.trace().states == ({"p": False, "q": True},)
        assert contest.trace_as_usual({"p"}).states == ({"p": False, "q": True},)
        assert contest.trace_as_usual({"q"}) is None


class TestDiverseWitnesses:
    def test_each_reason_is_found(self):
        reasons = [P, ALONE[3], Atom("follows", ("x", "y"))]
        forbidding, allowing = sides([always(no(either(*reasons))), always(no(no(no(P))))], [X, Y])
        _, allowing = sides([always(P), always(either(P, no(P)))], [X, Y])
        contest = Contest(forbidding, [allowing])
        first = contest.trace()
        found = diverse_witnesses(contest, first, 5)
        names = [non_default_names(one, VOCABULARY) for one in found]
        assert sorted(map(sorted, names)) == [["follows"], ["p"], ["speed"]]
        assert found[0] is first
        assert diverse_witnesses(contest, first, 2) == found[:2]
        assert diverse_witnesses(contest, first, 1) == (first,)

    def test_where_nothing_does_without_no_less_is_asked(self, monkeypatch):
        fast, follows = ALONE[3], Atom("follows", ("x", "y"))
        forbidden = Binary(BinaryOperator.AND, P, either(fast, follows))
        forbidding, _ = sides([always(no(forbidden)), always(P)], [X, Y])
        _, allowing = sides([always(P), always(either(P, no(P)))], [X, Y])
        asked = []

        contest = Contest(forbidding, [allowing])
        first, trace_as_usual = contest.trace(), contest.trace_as_usual

        def counted(names):
            asked.append(names)
            return trace_as_usual(names)

        monkeypatch.setattr(contest, "trace_as_usual", counted)
        found = diverse_witnesses(contest, first, 5)
        names = [sorted(non_default_names(one, VOCABULARY)) for one in found]
        assert sorted(names) == [["follows", "p"], ["p", "speed"]]
        # Without one of the two, without `p`, without both; without one of them and `p` is clear.
        assert len(asked) == 3

    def test_names_with_another_value_than_the_default(self):
        trace = Trace(
            "t", 1.0, {"x": "thing"}, ({"speed": 0.0}, {"p": True, "place": {"x": "near"}})
        )
        # Without a default nothing is as usual.
        assert non_default_names(trace, VOCABULARY) == {"p"}


class TestRuleComparison:
    @pytest.mark.parametrize(
        ("first", "second", "relation"),
        [
            (None, None, "equal"),
            ("t", None, "stricter"),
            (None, "t", "laxer"),
            ("t", "t", "incomparable"),
        ],
    )
    def test_relations(self, first, second, relation):
        assert relation_of(first, second) == relation
        assert relation_of(second, first) == CONVERSE[relation]

    @given(st.tuples(*[formulas(ALONE[:3])] * 2))
    @settings(max_examples=settings().max_examples // 2)
    def test_the_converse_is_the_other_way_around(self, pair):
        one, other = sides(pair, [X])
        assert compare(other, one).relation == CONVERSE[compare(one, other).relation]

    @pytest.mark.parametrize(
        ("first", "second", "expected"),
        [
            (["thing"], ["thing"], None),
            (["thing"], ["car"], ("car",)),
            (["car", "thing"], ["thing", "car"], None),
            (["thing", "thing"], ["car", "thing"], ("car", "thing")),
            (["thing"], ["thing", "thing"], None),
            (["car"], ["tree"], ()),
            (["car", "car"], ["thing", "tree"], ()),
        ],
    )
    def test_common_types(self, first, second, expected):
        heads = [
            [Variable(f"v{n}", kind) for n, kind in enumerate(kinds)] for kinds in (first, second)
        ]
        assert common_types(*heads, VOCABULARY) == expected

    def test_the_same_law_is_not_searched(self):
        one, other = sides([always(P), always(no(P))], [X])
        assert compare(one, replace(other, law=one.law)).relation == "equal"


HEAD = "signal p, q default false\n"


def book(name, *rules, extra=""):
    return parse_rulebook(
        f"rulebook {name}\n{HEAD}{extra}"
        + "".join(f"hard rule {rule} {{ require {text} }}\n" for rule, text in rules)
    )


def comparison_matrix(books, *more):
    """The last matrix, of all rulebooks."""
    *_, last = growing_matrices(with_distinct_names(books), *more)
    return last


BOOKS = [
    book("a", ("r", "never p"), ("s", "never q"), ("only", "p")),
    book("b", ("r", "always not p"), ("s", "never (p and q)")),
    book("c", ("r", "never (p or q)"), extra='silent on s because "nobody knows"\n'),
]


class TestComparisonMatrix:
    def test_laws_and_relations(self):
        matrix = comparison_matrix(BOOKS)
        by_name = {one.name: one for one in matrix.rules}
        assert [one.name for one in matrix.rules] == ["r", "s", "only"]
        assert [one.name for one in matrix.shared] == ["r", "s"]
        assert [by_name["r"].letter(name) for name in "abc"] == ["A", "A", "B"]
        assert [by_name["s"].letter(name) for name in "abc"] == ["A", "B", ""]
        assert by_name["r"].relation("a", "b") == "equal"
        assert by_name["r"].relation("c", "a") == "stricter"
        assert by_name["s"].relation("b", "a") == "laxer"
        assert by_name["s"].relation("a", "c") is None
        assert by_name["s"].remarks["c"].because == "nobody knows"
        assert by_name["only"].letter("a") == "A"
        assert matrix.is_complete
        assert not matrix.is_uniform
        assert matrix.counts("a", "b") == {"equal": 1, "stricter": 1, "only": 1, "silent": 0}
        assert matrix.counts("a", "c") == {"laxer": 1, "only": 2, "silent": 1}
        assert comparison_matrix(BOOKS, ["only"]).is_uniform

    def test_relations_of_laws_are_those_of_rules(self):
        for shared in comparison_matrix(BOOKS).shared:
            for one, other in product(shared.laws, repeat=2):
                assert shared.relation(other, one) == CONVERSE[shared.relation(one, other)]

    def test_each_book_is_compared_before_the_next_is_read(self):
        read = []

        def reading():
            for one in BOOKS:
                read.append(one.name)
                yield one

        for number, matrix in enumerate(growing_matrices(reading()), 1):
            assert read == [one.name for one in matrix.books] == ["a", "b", "c"][:number]
            (shared, *_) = matrix.rules
            assert [*shared.laws] == read
        assert shared.relation("a", "b") == "equal"

    def test_steps_of_rules_may_differ(self):
        timed = []
        for name, bound, step_s in (
            ("a", 2, 1),
            ("b", 1, Fraction(1, 2)),
            ("c", 2, Fraction(1, 4)),
        ):
            one = book(name, ("r", f"eventually[<= {bound} s] p"))
            timed.append(replace(one, rules=(replace(one.rules[0], step_s=Fraction(step_s)),)))
        (shared,) = comparison_matrix(timed).rules
        assert [shared.letter(name) for name in "abc"] == ["A", "B", "A"]
        assert shared.relation("b", "c") == "stricter"

    def test_more_pairs_than_the_limit_are_refused_at_a_rule_that_most_have(self, monkeypatch):
        monkeypatch.setenv("RULEC_LIMITS", "comparisons=4")
        assert len(comparison_matrix(BOOKS).shared) == 2
        monkeypatch.setenv("RULEC_LIMITS", "comparisons=3")
        with pytest.raises(RulecError) as caught:
            comparison_matrix(BOOKS)
        (one,) = caught.value.diagnostics
        assert (one.code, one.place.line) == ("R0718", 3)
        assert "3 rulebooks, 3 of which have `r`: 4 pairs" in one.message
        assert "--limit comparisons=" in one.help

    def test_more_laws_than_letters(self):
        (one, *_) = comparison_matrix(BOOKS).rules
        assert replace(one, laws={"a": 27}).letter("a") == "B1"


class TestRulebookComparison:
    def test_rules_of_one_name_are_compared(self):
        diff = diff_rulebooks(*BOOKS[:2])
        assert [(one.name, one.relation) for one in diff.pairs] == [
            ("r", "equal"),
            ("s", "stricter"),
        ]
        assert [one.rule.name for one in diff.only_first] == ["only"]
        assert diff.only_second == ()
        assert diff.is_complete
        assert not diff.is_none
        (trace,) = diff.witnesses
        assert trace.id == "s: a forbids, b allows"
        ((forbids, allows_it, table),) = diff.tables(diff.pairs[1])
        assert (forbids, allows_it) == ("a", "b")
        assert [row.title for row in table.rows] == ["p", "q"]

    def test_what_the_other_says_of_a_rule_that_it_lacks(self):
        diff = diff_rulebooks(BOOKS[0], BOOKS[2])
        remarks = {one.rule.name: one.remark for one in diff.only_first}
        assert remarks["s"].because == "nobody knows"
        assert remarks["only"] is None

    def test_traces_are_numbered(self):
        first = book("a", ("r", "never (p or q)"))
        diff = diff_rulebooks(first, book("b", ("r", "true")), most=3)
        assert [one.id for one in diff.witnesses] == [
            "r: a forbids, b allows",
            "r: a forbids, b allows (2)",
        ]

    def test_a_rulebook_is_as_itself(self):
        diff = diff_rulebooks(BOOKS[0], BOOKS[0])
        assert diff.is_none
        assert list(diff.witnesses) == []

    def test_softer_rules_are_not_the_same(self):
        soft = replace(BOOKS[1], rules=(replace(BOOKS[1].rules[0], strength="soft", weight=2.0),))
        hard = replace(BOOKS[1], rules=BOOKS[1].rules[:1])
        diff = diff_rulebooks(hard, soft)
        assert not diff.is_none
        assert [one[0] for one in diff.pairs[0].notes] == ["strength", "weight"]

    def test_patterns(self):
        assert list(rules_matching(BOOKS[0], [])) == ["r", "s", "only"]
        assert list(rules_matching(BOOKS[0], ["o*", "?"])) == ["r", "s", "only"]
        assert list(rules_matching(BOOKS[0], ["o*"])) == ["only"]

    def test_progress_and_steps(self):
        told = []
        timed = [
            parse_rulebook(f"rulebook {name}\n{HEAD}hard rule r {{ require eventually[<= 2 s] p }}")
            for name in "ab"
        ]
        diff = diff_rulebooks(*timed, step_s=Fraction(1, 2), tell=told.append)
        assert told == [1]
        assert diff.pairs[0].machines[0].step_s == Fraction(1, 2)


def constants(*histories):
    return BookLineage((BookHeader("b"),), (), histories)


def history(name, *values, kind="parameter"):
    settings_ = tuple(ConstantValue("b", text, current=current) for text, current in values)
    return ConstantHistory(kind, name, name, settings_)


class TestSettings:
    def test_values_that_count_today(self):
        first = constants(
            history("limit", ("50 km/h", False), ("60 km/h", True)),
            history("same", ("1 m", True)),
            history("kind", ("on", True), kind="option"),
            history("word", ("p", True), kind="definition"),
            history("mine", ("1 m", True)),
        )
        second = constants(
            history("limit", ("50 km/h", True)),
            history("same", ("1 m", True)),
            history("kind", ("1 m", True)),
            history("word", ("q", True), kind="definition"),
        )
        (pair,) = setting_pairs(first, second)
        assert (pair.kind, pair.name, pair.first, pair.second) == (
            *("parameter", "limit"),
            *("60 km/h", "50 km/h"),
        )
        outdated = constants(history("limit", ("50 km/h", False)))
        assert setting_pairs(outdated, second)[0].first == ""


class TestRuleHistory:
    HISTORY = RuleHistory(
        "r",
        (
            LineageStep("a", "declared", "first"),
            LineageStep("b", "overridden", "second", ("cite", "says"), gives_law=True),
            LineageStep("c", "softened", "third", ("hard or soft",)),
            LineageStep("d", "dropped", None),
        ),
    )

    def test_the_last_step_counts(self):
        assert self.HISTORY.last.deed == "dropped"
        assert self.HISTORY.rule is None
        assert self.HISTORY.cited_by == "b"

    def test_what_a_book_has_inherited(self):
        before = replace(self.HISTORY, steps=self.HISTORY.steps[:3])
        assert before.before("c") == "second"
        assert before.before("x") == "third"
        assert replace(before, steps=before.steps[:1]).before("a") is None

    def test_a_topic_has_no_citation(self):
        silent = RuleHistory("s", (LineageStep("b", "silent", None),))
        assert silent.cited_by == ""


def test_allowed_traces_are_not_witnesses():
    one, other = sides([always(no(P)), always(P)], [X])
    found = compare(one, other)
    assert all(allows(other, trace) for trace in found.first_forbids)


BELOW_ZERO = """rulebook {name}
signal wet default false
quantity gap in m default 100
quantity speed in km/h default 0
quantity grade in m/s^2 default 0
hard rule r {{ require always ({required}) }}
"""


@pytest.mark.parametrize(
    ("forbidding", "allowing", "below"),
    [
        # Less than two seconds, but four seconds: only for who drives backwards
        ("gap >= 2 s * speed and not wet", "gap >= 4 s * speed", ()),
        ("gap >= 2 s * speed", "gap >= 4 s * speed", ("gap", "speed")),
        ("gap >= 0 m", "true", ("gap",)),
        ("grade >= -5 m/s^2", "true", ("grade",)),
    ],
)
def test_numbers_are_below_zero_where_nothing_else_shows_the_difference(
    forbidding, allowing, below
):
    books = [
        parse_rulebook(BELOW_ZERO.format(name=name, required=required))
        for name, required in (("a", forbidding), ("b", allowing))
    ]
    ours, theirs = compile_shared(books, [{"r": book.rules[0]} for book in books])
    found = compare(ours["r"], theirs["r"], most=3).first_forbids
    assert found
    for trace in found:
        numbers = {
            name
            for state in trace.states
            for name, value in state.items()
            if not isinstance(value, bool | str) and value < 0
        }
        assert numbers == set(below)


OLD = (
    "rulebook depot signal red, near default false hard rule slow { require never (red and near) }"
)


def test_editions_of_one_name_are_told_apart_by_their_files(tmp_path):
    new = OLD.replace("(red and near)", "red")
    books = []
    for folder, text in (("old", OLD), ("new", new)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "depot.rules").write_text(text)
        books.append(load_rulebook(tmp_path / folder / "depot.rules"))
    names = ["depot (old/depot.rules)", "depot (new/depot.rules)"]
    diff = diff_rulebooks(*books)
    assert [diff.first.name, diff.second.name] == names
    ((forbids, allows, _),) = diff.tables(diff.pairs[0])
    assert (forbids, allows) == (names[1], names[0])
    matrix = comparison_matrix(books)
    assert [book.name for book in matrix.books] == names
    (rule,) = matrix.shared
    assert (rule.relation(*names), rule.relation(*names[::-1])) == ("laxer", "stricter")


def test_editions_without_files_are_numbered():
    books = [parse_rulebook(OLD), parse_rulebook(OLD)]
    assert [book.name for book in comparison_matrix(books).books] == ["depot (1)", "depot (2)"]


def test_books_that_declare_a_type_differently_have_no_tables():
    other = OLD.replace("signal", "type tram signal").replace(
        "near default", "near(x: tram), other default"
    )
    one = parse_rulebook(other.replace("(red and near)", "red"))
    two = parse_rulebook(
        other.replace("type tram", "type rail type tram is rail").replace("(red and near)", "other")
    )
    diff = diff_rulebooks(one, two)
    assert diff.pairs[0].comparison.undecided == "`tram` is a different type in the two"
    assert list(diff.tables(diff.pairs[0])) == []


TYPED = "rulebook {} type t type {} is t signal near(c: t) default false "


def test_books_that_each_lack_the_types_of_the_other():
    rule = "hard rule r (c: {}) {{ require never near(c) }}"
    one = parse_rulebook(TYPED.format("a", "car") + rule.format("car"))
    other = parse_rulebook(TYPED.format("b", "bus") + rule.format("bus"))
    comparison = diff_rulebooks(one, other).pairs[0].comparison
    assert (comparison.relation, comparison.common, comparison.on_common) == (
        "incomparable",
        (),
        None,
    )
    # The narrower type is one that the first rulebook does not have.
    wide = parse_rulebook(TYPED.format("c", "car") + rule.format("t"))
    comparison = diff_rulebooks(wide, other).pairs[0].comparison
    assert (comparison.relation, comparison.common, comparison.on_common) == (
        "stricter",
        ("bus",),
        "equal",
    )
