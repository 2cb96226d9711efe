"""How formulas are read: the paper's statements, the language's table, both spellings."""

import pytest

from rulec.syntax import parse_formula, print_formula

SAME = [
    # The paper, Section IV-A.
    ("p1 U X p2", "p1 U (X p2)"),
    ("p1 U p2 U p3", "p1 U (p2 U p3)"),
    ("! X p", "!(X p)"),
    ("X ! p", "X(!p)"),
    ("a U b & c", "(a U b) & c"),
    ("a & b U c", "a & (b U c)"),
    ("a U b | c U d", "(a U b) | (c U d)"),
    ("a U b -> c U d", "(a U b) -> (c U d)"),
    # Unary operators bind tightest.
    ("!a U b", "(!a) U b"),
    ("G a U b", "(G a) U b"),
    ("weak next a and b", "(weak next a) and b"),
    ("not always p implies q", "(not (always p)) implies q"),
    ("never p until q", "(never p) until q"),
    ("once p and historically not q", "(once p) and (historically (not q))"),
    ("weak previously p since q", "(weak previously p) since q"),
    ("O H Y p", "O(H(Y p))"),
    # Until and its family are one level and associate to the right.
    ("a U b R c W d M e S f", "a U (b R (c W (d M (e S f))))"),
    # From until outward: and, or, xor, then, implies, iff.
    ("a U b & c | d ^ e then f -> g <-> h", "((((((a U b) & c) | d) ^ e) then f) -> g) <-> h"),
    ("a <-> b -> c then d ^ e | f & g U h", "a <-> (b -> (c then (d ^ (e | (f & (g U h))))))"),
    # Phases: what stands between two `then` is one phase, and they come from left to right.
    ("a then b then c then d", "a then (b then (c then d))"),
    (
        "behind(v) then beside(v) and left_of(v) then in_front_of(v)",
        "behind(v) then (beside(v) and left_of(v)) then in_front_of(v)",
    ),
    ("a then b or c then d", "a then (b or c) then d"),
    ("p implies a then b", "p implies (a then b)"),
    # Implies associates to the right, the other Boolean operators to the left.
    ("a -> b -> c", "a -> (b -> c)"),
    ("a <-> b <-> c", "(a <-> b) <-> c"),
    ("a & b & c", "(a & b) & c"),
    ("a | b | c", "(a | b) | c"),
    ("a ^ b ^ c", "(a ^ b) ^ c"),
    # Comparisons bind tighter than operators of truth, arithmetic tighter than comparisons.
    ("not a < b", "not (a < b)"),
    ("always a < b and c", "(always (a < b)) and c"),
    ("a < b until c = d", "(a < b) until (c = d)"),
    ("a + b * c - d", "(a + (b * c)) - d"),
    ("a - b - c", "(a - b) - c"),
    ("a / b / c * d", "((a / b) / c) * d"),
    ("a < b + c", "a < (b + c)"),
    ("-a * b", "(-a) * b"),
    ("a - -b", "a - (-b)"),
    ("a--b", "a - (-b)"),
    ("2 s * speed + gap >= 1.5 m", "((2 s * speed) + gap) >= 1.5 m"),
    ("3 m/s / 2 s", "(3 m/s) / (2 s)"),
    # A conditional binds loosest; the condition stands between its words.
    ("(a if p or q else b if r else c)", "(a if (p or q) else (b if r else c))"),
    ("(a + b if p else c < d)", "((a + b) if p else (c < d))"),
    # Bounds belong to the operator before them.
    ("always[<= 3 s] p until[1 s .. 2 s] q", "(always[<= 3 s] p) until[1 s .. 2 s] q"),
    ("a then[2 s] b then c", "a then[2 s] (b then c)"),
    ("weak next[2 steps] not p", "weak next[2 steps] (not p)"),
    ("G[>=1s]p", "always[>= 1 s] p"),
    ("a U[wait] b", "a until[wait] b"),
    # Counting.
    ("count x: T (p or q) + 1 > 2 and r", "((count x: T ((p or q)) + 1) > 2) and r"),
    ("not some x: T (p) until q", "(not some x: T (p)) until q"),
    # One operator, several spellings.
    ("a && b || c", "a and b or c"),
    ("[] p", "always p"),
    ("<> p", "eventually p"),
    ("[]<>p", "G F p"),
    ("a weak until b", "a W b"),
    ("a strong release b", "a M b"),
    ("a release b", "a R b"),
    ("a until b", "a U b"),
    ("next p", "X p"),
    ("a xor b", "a ^ b"),
    ("a iff b", "a <-> b"),
    ("a implies b", "a -> b"),
    ("not p", "!p"),
    ("once p", "O p"),
    ("historically p", "H p"),
    ("previously p", "Y p"),
    ("a since b", "a S b"),
    ("weak\npreviously p", "weak previously p"),
    # Names that only begin like a word or an operator.
    ("untilx U Gp", "(untilx) U (Gp)"),
    ("a\n  U # comment\n b", "a U b"),
]


@pytest.mark.parametrize(("text", "meaning"), SAME)
def test_reads_as(text, meaning):
    assert parse_formula(text) == parse_formula(meaning)


DIFFERENT = [
    ("!a U b", "!(a U b)"),
    ("a U b U c", "(a U b) U c"),
    ("a then b then c", "(a then b) then c"),
    ("never a then b", "never (a then b)"),
    ("previously p", "weak previously p"),
    ("a -> b -> c", "(a -> b) -> c"),
    ("a & (b & c)", "a & b & c"),
    ("Gp", "G p"),
    ("a - (b - c)", "a - b - c"),
    ("-(a * b)", "-a * b"),
    ("a * (b + c)", "a * b + c"),
    ("next[2 steps] p", "next p"),
    ("eventually[3 s] p", "eventually[<= 3 s] p"),
    ("eventually[3 s] p", "eventually[3 s .. 3 s] p"),
    ("always[<= 3 s] p", "always[0 s .. 3 s] p"),
    ("(a if p else b) > c", "(a if p else b > c)"),
]


@pytest.mark.parametrize(("text", "other"), DIFFERENT)
def test_differs_from(text, other):
    assert parse_formula(text) != parse_formula(other)


def test_the_paper_s_rule_prints_as_the_paper_has_it():
    text = "!CONGESTED -> G !(b_v & X (b_v U r_v U f_v))"
    assert print_formula(parse_formula(text), "symbols") == text
    words = "not CONGESTED implies always not (b_v and next (b_v until r_v until f_v))"
    assert print_formula(parse_formula(text)) == words


def test_operators_without_a_symbol_keep_their_words():
    text = "never (O p then weak previously q S weak next p)"
    assert print_formula(parse_formula(text), "symbols") == text
    words = "never (once p then weak previously q since weak next p)"
    assert print_formula(parse_formula(text)) == words
