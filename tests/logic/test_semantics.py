"""The meaning of the operators, against the paper's Table I and against each other."""

from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Constant,
    Same,
    Unary,
    UnaryOperator,
)
from rulec.logic.printing import formula_text
from rulec.logic.semantics import holds, truth_values
from rulec.rulebook.loader import parse_rulebook
from support.generators.random_formulas import formulas, letters, words
from support.generators.timed_formulas import (
    comparison,
    letters_of,
    timed_formulas,
    timed_words,
    without_bounds,
)
from support.oracles.formula_oracle import by_definition

X, Y = Atom("x"), Atom("y")

# Table I: x = T F T T, y = F T F F, and so on with the last one for ever.
TABLE_I_WORD = [frozenset({X}), frozenset({Y}), frozenset({X}), frozenset({X})]
TABLE_I = {
    "next x": (Unary(UnaryOperator.NEXT, X), "FTTT"),
    "always x": (Unary(UnaryOperator.ALWAYS, X), "FFTT"),
    "eventually y": (Unary(UnaryOperator.EVENTUALLY, Y), "TTFF"),
    "y until x": (Binary(BinaryOperator.UNTIL, Y, X), "TTTT"),
}


@pytest.mark.parametrize("row", TABLE_I)
def test_table_i_of_the_paper(row):
    formula, expected = TABLE_I[row]
    assert truth_values(formula, TABLE_I_WORD) == [value == "T" for value in expected]


def test_the_last_letter_goes_on_for_ever():
    assert truth_values(Unary(UnaryOperator.NEXT, Y), [frozenset({Y})]) == [True]
    assert truth_values(Unary(UnaryOperator.ALWAYS, Y), [frozenset(), frozenset({Y})]) == [
        False,
        True,
    ]


# Worked out by hand: x = T F F T F T, y = F F T F T F.
PAST_WORD = [frozenset(one) for one in ({X}, {}, {Y}, {X}, {Y}, {X})]
PAST = {
    "previously x": (Unary(UnaryOperator.PREVIOUSLY, X), "FTFFTF"),
    "weak previously x": (Unary(UnaryOperator.WEAK_PREVIOUSLY, X), "TTFFTF"),
    "once y": (Unary(UnaryOperator.ONCE, Y), "FFTTTT"),
    "historically x": (Unary(UnaryOperator.HISTORICALLY, X), "TFFFFF"),
    "x since y": (Binary(BinaryOperator.SINCE, X, Y), "FFTTTT"),
    "y since x": (Binary(BinaryOperator.SINCE, Y, X), "TFFTTT"),
    "never y": (Unary(UnaryOperator.NEVER, Y), "FFFFFT"),
    "x then y": (Binary(BinaryOperator.THEN, X, Y), "FFFTFF"),
}


@pytest.mark.parametrize("row", PAST)
def test_the_past_by_hand(row):
    formula, expected = PAST[row]
    assert truth_values(formula, PAST_WORD) == [value == "T" for value in expected]


def test_the_past_of_an_instant_that_repeats_the_last_letter():
    """The word x stands for x x x …: in its second instant there was an x before."""
    twice = Unary(UnaryOperator.PREVIOUSLY, Unary(UnaryOperator.PREVIOUSLY, X))
    thrice = Unary(UnaryOperator.PREVIOUSLY, twice)
    exactly = Bound(Fraction(2), Fraction(2), "steps")
    since = Binary(BinaryOperator.SINCE, X, twice, exactly)
    for formula in (twice, thrice, since):
        assert not holds(formula, [{X}])
        assert holds(Unary(UnaryOperator.EVENTUALLY, formula), [{X}])
        at_last = Unary(UnaryOperator.EVENTUALLY, Unary(UnaryOperator.ALWAYS, formula))
        assert holds(at_last, [{}, {X}])
        assert not holds(at_last, [{X}, {}])


THEN = BinaryOperator.THEN
A, B, C = Atom("a"), Atom("b"), Atom("c")
PHASES = [
    ("abc", True),
    ("aabbccaa", True),
    ("ab", False),
    ("ac", False),  # the middle phase lasts at least one instant
    ("xabc", False),  # the first phase begins now
    ("axbc", False),  # no break
    ("abxc", False),
    ("abac", False),
]


@pytest.mark.parametrize(("text", "expected"), PHASES)
def test_phases_follow_one_another_without_a_break(text, expected):
    formula = Binary(THEN, A, Binary(THEN, B, C))
    assert holds(formula, [{Atom(one)} for one in text]) == expected


def test_phases_share_no_instant():
    both = frozenset({A, B})
    assert not holds(Binary(THEN, A, B), [both, frozenset()])
    assert holds(Binary(THEN, A, B), [both, both, frozenset()])
    assert holds(Binary(THEN, A, B), [both])  # for it goes on


def test_the_papers_sequence_lets_the_middle_phase_be_empty():
    later = Unary(UnaryOperator.NEXT, Binary(BinaryOperator.UNTIL, B, C))
    paper = Binary(BinaryOperator.AND, A, later)
    assert holds(paper, [{A}, {C}])
    assert not holds(Binary(THEN, A, Binary(THEN, B, C)), [{A}, {C}])


def steps(low, high):
    return Bound(Fraction(low), None if high is None else Fraction(high), "steps")


# Worked out by hand: x = T F F T F T and so on, y = F F T F T F and so on.
BOUNDED = {
    "next[2] x": (Unary(UnaryOperator.NEXT, X, steps(2, 2)), "FTFTTT", "FTFTFF"),
    "weak next[2] x": (Unary(UnaryOperator.WEAK_NEXT, X, steps(2, 2)), "FTFTTT", "FTFTTT"),
    "next[0] x": (Unary(UnaryOperator.NEXT, X, steps(0, 0)), "TFFTFT", "TFFTFT"),
    "eventually[<= 1] x": (Unary(UnaryOperator.EVENTUALLY, X, steps(0, 1)), "TFTTTT", "TFTTTT"),
    "eventually[1 .. 2] y": (Unary(UnaryOperator.EVENTUALLY, Y, steps(1, 2)), "TTTTFF", "TTTTFF"),
    "always[1 .. 2] x": (Unary(UnaryOperator.ALWAYS, X, steps(1, 2)), "FFFFTT", "FFFFTT"),
    "always[1 .. 2] y": (Unary(UnaryOperator.ALWAYS, Y, steps(1, 2)), "FFFFFF", "FFFFFT"),
    "never[<= 1] y": (Unary(UnaryOperator.NEVER, Y, steps(0, 1)), "TFFFFT", "TFFFFT"),
    "eventually[>= 3] y": (Unary(UnaryOperator.EVENTUALLY, Y, steps(3, None)), "TTFFFF", "TTFFFF"),
    "y until[<= 1] x": (Binary(BinaryOperator.UNTIL, Y, X, steps(0, 1)), "TFTTTT", "TFTTTT"),
    "x release[<= 1] y": (Binary(BinaryOperator.RELEASE, X, Y, steps(0, 1)), "FFFFFF", "FFFFFF"),
    "y weak until[1 .. 1] x": (
        Binary(BinaryOperator.WEAK_UNTIL, Y, X, steps(1, 1)),
        "FFTFTF",
        "FFTFTF",
    ),
    "y weak until[<= 2] x": (
        Binary(BinaryOperator.WEAK_UNTIL, Y, X, steps(0, 2)),
        "TFTTTT",
        "TFTTTT",
    ),
    "x then[<= 1] y": (Binary(BinaryOperator.THEN, X, Y, steps(0, 1)), "FFFTFF", "FFFTFF"),
    "x then[2 .. 3] y": (Binary(BinaryOperator.THEN, X, Y, steps(2, 3)), "FFFFFF", "FFFFFF"),
    "once[1 .. 2] x": (Unary(UnaryOperator.ONCE, X, steps(1, 2)), "FTTFTT", "FTTFTT"),
    "historically[1 .. 2] y": (
        Unary(UnaryOperator.HISTORICALLY, Y, steps(1, 2)),
        "TFFFFF",
        "TFFFFF",
    ),
    "previously[2] x": (Unary(UnaryOperator.PREVIOUSLY, X, steps(2, 2)), "FFTFFT", "FFTFFT"),
    "weak previously[2] x": (
        Unary(UnaryOperator.WEAK_PREVIOUSLY, X, steps(2, 2)),
        "TTTFFT",
        "TTTFFT",
    ),
    "x since[1 .. 2] y": (Binary(BinaryOperator.SINCE, X, Y, steps(1, 2)), "FFFTFT", "FFFTFT"),
}


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@pytest.mark.parametrize("row", BOUNDED)
def test_bounds_by_hand(row, semantics):
    formula, *expected = BOUNDED[row]
    wanted = expected[semantics == "finite"]
    values = truth_values(formula, PAST_WORD, semantics)
    assert values == [value == "T" for value in wanted]


# What there is after the last instant: its like for ever, or nothing.
ENDS = {
    "next x": (Unary(UnaryOperator.NEXT, X), True, False),
    "weak next y": (Unary(UnaryOperator.WEAK_NEXT, Y), False, True),
    "always x": (Unary(UnaryOperator.ALWAYS, X), True, True),
    "next eventually x": (
        Unary(UnaryOperator.NEXT, Unary(UnaryOperator.EVENTUALLY, X)),
        True,
        False,
    ),
    "x then x": (Binary(BinaryOperator.THEN, X, X), True, False),
    "eventually[2] x": (Unary(UnaryOperator.EVENTUALLY, X, steps(2, 2)), True, False),
    "always[2] y": (Unary(UnaryOperator.ALWAYS, Y, steps(2, 2)), False, True),
    "y release x": (Binary(BinaryOperator.RELEASE, Y, X), True, True),
    "y strong release x": (Binary(BinaryOperator.STRONG_RELEASE, Y, X), False, False),
    "x weak until y": (Binary(BinaryOperator.WEAK_UNTIL, X, Y), True, True),
    "eventually once[3] x": (
        Unary(UnaryOperator.EVENTUALLY, Unary(UnaryOperator.ONCE, X, steps(3, 3))),
        True,
        False,
    ),
}


@pytest.mark.parametrize("row", ENDS)
def test_how_a_word_ends(row):
    formula, stutter, finite = ENDS[row]
    assert holds(formula, [{X}], "stutter") is stutter
    assert holds(formula, [{X}], "finite") is finite


both_semantics = st.sampled_from(["stutter", "finite"])


@given(timed_formulas, timed_words, both_semantics)
@example(ENDS["eventually once[3] x"][0], [{"x": True}], "stutter")
def test_the_definitions_read_again(formula, word, semantics):
    """Instant by instant, without any thrift."""
    letters = letters_of(formula, word)
    expected = by_definition(formula, letters, semantics)
    assert truth_values(formula, letters, semantics) == expected


@given(timed_formulas, timed_words, both_semantics)
def test_bounds_unrolled_mean_the_same(formula, word, semantics):
    """A bound is a shorthand: step by step it can be said with next and previously."""
    letters = letters_of(formula, word)
    unrolled = without_bounds(formula)
    assert truth_values(unrolled, letters, semantics) == truth_values(formula, letters, semantics)


def test_a_long_bound_takes_no_longer():
    far = steps(10**12, None)
    formula = Unary(UnaryOperator.EVENTUALLY, Unary(UnaryOperator.ALWAYS, X, far))
    assert holds(formula, [{}, {X}])
    assert not holds(formula, [{X}, {}])
    assert not holds(Unary(UnaryOperator.EVENTUALLY, X, far), [{X}, {X}], "finite")


def test_numbers_are_members_of_a_letter_like_atoms():
    fast = comparison("speed", ">", 30)
    assert holds(Unary(UnaryOperator.NEXT, fast), [{X}, {fast}])
    assert not holds(Unary(UnaryOperator.NEXT, fast), [{fast}, {X}])


def test_what_has_no_meaning_on_a_word():
    seconds = Bound(Fraction(0), Fraction(3), "s")
    for formula in (
        Unary(UnaryOperator.ALWAYS, X, seconds),
        Unary(UnaryOperator.ONCE, X, Bound(Fraction(0), Fraction(1, 2), "steps")),
        Same("x", "y"),
    ):
        for semantics in ("stutter", "finite"):
            with pytest.raises(ValueError, match=r"step|counted"):
                holds(formula, [{X}], semantics)


def test_an_empty_word_has_no_meaning():
    for semantics in ("stutter", "finite"):
        with pytest.raises(ValueError, match="empty"):
            holds(Constant(True), [], semantics)


def expanded(formula, word):
    """An evaluation that shares nothing with the one under test: unfold each operator by its
    expansion law, and iterate over the instants until nothing changes any more. The last letter is
    repeated once for every operator, more often than any of them can look back."""
    return fixpoint(formula, [*word, *[word[-1]] * size(formula)])[: len(word)]


def size(formula):
    match formula:
        case Unary(_, operand):
            return 1 + size(operand)
        case Binary(_, left, right):
            return 1 + size(left) + size(right)
    return 0


def fixpoint(formula, word):
    n = len(word)
    following = [min(i + 1, n - 1) for i in range(n)]

    def solve(start, update):
        """For updates by the value that follows."""
        return solve_in_place(start, lambda i, values: update(i, values[following[i]]))

    def look_back(at_first, update):
        """For updates by the value before, which there is none of at the first instant."""
        return solve_in_place(
            False, lambda i, values: update(i, values[i - 1]) if i else at_first(0)
        )

    def solve_in_place(start, update):
        values = [start] * n
        while True:
            renewed = [update(i, values) for i in range(n)]
            if renewed == values:
                return values
            values = renewed

    match formula:
        case Atom():
            return [formula in letter for letter in word]
        case Constant(value):
            return [value] * n
        case Unary(operator, operand):
            a = fixpoint(operand, word)
            return {
                "not": lambda: [not v for v in a],
                "next": lambda: [a[following[i]] for i in range(n)],
                "weak next": lambda: [a[following[i]] for i in range(n)],
                "always": lambda: solve(True, lambda i, later: a[i] and later),
                "never": lambda: solve(True, lambda i, later: not a[i] and later),
                "eventually": lambda: solve(False, lambda i, later: a[i] or later),
                "previously": lambda: [i > 0 and a[i - 1] for i in range(n)],
                "weak previously": lambda: [i == 0 or a[i - 1] for i in range(n)],
                "once": lambda: look_back(lambda i: a[i], lambda i, before: a[i] or before),
                "historically": lambda: look_back(
                    lambda i: a[i], lambda i, before: a[i] and before
                ),
            }[operator.value]()
        case Binary(operator, left, right):
            a, b = fixpoint(left, word), fixpoint(right, word)

            def until():
                return solve(False, lambda i, later: b[i] or (a[i] and later))

            return {
                "and": lambda: [a[i] and b[i] for i in range(n)],
                "or": lambda: [a[i] or b[i] for i in range(n)],
                "implies": lambda: [b[i] if a[i] else True for i in range(n)],
                "iff": lambda: [a[i] is b[i] for i in range(n)],
                "xor": lambda: [a[i] is not b[i] for i in range(n)],
                "until": until,
                "weak until": lambda: solve(True, lambda i, later: b[i] or (a[i] and later)),
                "release": lambda: solve(True, lambda i, later: b[i] and (a[i] or later)),
                "strong release": lambda: solve(False, lambda i, later: b[i] and (a[i] or later)),
                "then": lambda: [a[i] and until()[following[i]] for i in range(n)],
                "since": lambda: look_back(
                    lambda i: b[i], lambda i, before: b[i] or (a[i] and before)
                ),
            }[operator.value]()


@given(formulas, words)
def test_evaluation_agrees_with_the_expansion_laws(formula, word):
    assert truth_values(formula, letters(word)) == expanded(formula, letters(word))


@given(formulas, formulas, words)
def test_looking_back_is_looking_ahead_in_a_mirror(left, right, word):
    """Where operands speak of the present alone, `since` is `until` on the word read backwards."""
    a, b = (frozen(one, "pq"[n], letters(word)) for n, one in enumerate((left, right)))
    both = [frozenset({*one, *other}) for one, other in zip(a, b, strict=True)]
    p, q = Atom("p"), Atom("q")
    since = truth_values(Binary(BinaryOperator.SINCE, p, q), both)
    until = truth_values(Binary(BinaryOperator.UNTIL, p, q), both[::-1])
    assert since == until[::-1]


def frozen(formula, name, word):
    """A word in which the atom ``name`` is true where the formula is in ``word``."""
    return [{Atom(name)} if value else set() for value in truth_values(formula, word)]


DECLARED = """rulebook printed
type thing
place(o: thing) is one of near, far, gone
light is one of red, green
signal p, q
hard rule r (x: thing) {{ require {} }}
"""


@given(formulas, words)
def test_a_formula_in_words_is_read_with_its_meaning(formula, word):
    """Chains may be read from the other side, which makes no difference."""
    text = formula_text(formula)
    (rule,) = parse_rulebook(DECLARED.format(text)).rules
    assert formula_text(rule.formula) == text
    assert truth_values(rule.formula, letters(word)) == truth_values(formula, letters(word))


def test_a_chain_of_phases_needs_no_parentheses():
    right = Binary(THEN, A, Binary(THEN, Binary(BinaryOperator.AND, B, C), A))
    assert formula_text(right) == "a then b and c then a"
    assert formula_text(Binary(THEN, Binary(THEN, A, B), C)) == "(a then b) then c"
    assert formula_text(Unary(UnaryOperator.NEVER, right)) == "never (a then b and c then a)"
