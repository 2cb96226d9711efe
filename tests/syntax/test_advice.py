"""Frequent mistakes: each gets the help that it needs."""

import pytest

from rulec.diagnostics import RulecError, Source
from rulec.syntax import parse, parse_formula
from rulec.syntax.messages.in_items import FORMS, IN_FORCE

COMPARED = (
    "quantities are compared by `=`, formulas by `iff`; one of several values is written alone: `q`"
)
NAMES = "names are made of letters, digits and `_`, and begin with a letter"
AS_OFTEN = "a state is one step long: write it as often as it lasts, with `;` between"
BOUNDS = "a bound is written `[<= 3 s]`, `[>= 1 s]`, `[1 s .. 4 s]` or `[2 steps]`"
BEHIND = "a bound follows its operator, such as `always[<= 3 s] p`"
OVER_TIME = "only operators over time take a bound, such as `always[<= 3 s]`"
BOTH_UNITS = "write the unit at both ends, and `..` between: `{}`"
BETWEEN_WORDS = "two words are joined by an operator, such as `and`"
OF_AN_OBJECT = f"{BETWEEN_WORDS}; what is of an object is written `{{}}`"
OR_AND = "write `or` where one of them is enough, `and` where it takes all"
TWO_ENDS = "write `..` between the two ends, such as `[3 s .. 4 s]`"
BY_SIGNS = "a quantity is compared by `<`, `<=`, `=`, `!=`, `>=` or `>`"
CHAINS = "`else` chains: write it "
AS_IN = "as in `3 m if wet else 2 m if dark else 1 m`"
CONDITIONAL = "a conditional is written `(1.5 m if built_up else 2 m)`"
DIGITS = "a number's digits are written together, such as `1000`"
NO_DATES = "an option has no dates; a parameter and a rule may have them"
NO_FUNCTION = "there is no"
ONE_BY_ONE = "one after the other, `x <= a"
BY_ITSELF = "each value stands for itself: write"
IN_A_FORMULA = "in a formula write"
A_CLAUSE = "of a whole rule it is a clause"
ONE_VARIABLE = "it has one variable; put one inside the other: "
LASTING = "how long something lasts is a bound, such as "
FORMULAS = [
    ("p => q", "=>", "write `implies` or `->`"),
    ("p → q", "→", "write `implies` or `->`"),
    ("p == q", "==", COMPARED),
    ("if p then q", "if", "write `p implies q` for `if p then q`"),
    (
        "if p then q else r",
        "if",
        "write `(p implies q) and (not p implies r)` for `if p then q else r`",
    ),
    ("p implies must q", "q", "leave out `must`; what a formula says must hold"),
    ("eventualy p", "p", "did you mean `eventually`?"),
    ("alway not p", "not", "did you mean `always`?"),
    ("p and eventualy next q", "next", "did you mean `eventually`?"),
    ("alway !p", "!", "did you mean `always`?"),
    ("historicaly true", "true", "did you mean `historically`?"),
    ("alway weak next p", "weak", "did you mean `always`?"),
    ("alway every x: T (p)", "every", "did you mean `always`?"),
    ("evry x: T (not p)", "x", "did you mean `every`?"),
    ("coun x: T (p) > 2", "x", "did you mean `count`?"),
    ("wek next p", "next", "did you mean `weak`?"),
    ("p wek until q", "wek", "did you mean `weak`?"),
    ("now not p", "not", "it comes before what it is about, such as `not (speed > 50 km/h)`"),
    ("p untl q", "untl", "did you mean `until`?"),
    ("p // why", "//", "a comment begins with `#`"),
    ("p <=> q", "<=>", "write `iff` or `<->`"),
    ("p ∧ q", "∧", "write `and` or `&`"),
    ("p ∨ q", "∨", "write `or` or `|`"),
    ("~p", "~", "write `not` or `!`"),
    ("¬p", "¬", "write `not` or `!`"),
    ("gap <= ½ m", "m", "write `0.5` for `½`"),
    ("p og q", "og", "write `and` or `&`"),
    ("p eller q", "eller", "write `or` or `|`"),
    ("p and nicht q", "q", "write `not` or `!` for `nicht`"),
    (
        "lane is kerb",
        "is",
        "a value is written alone, such as `kerb`; of an object it is `kerb(lane)`",
    ),
    ("gap >= at least 3 m", "least", "for `at least` write `>=`"),
    ("gap at least 3 m", "at", f"for `at least` write `>=`; {LASTING}`historically[>= 3 s] p`"),
    ("gap at most 3 m", "at", f"for `at most` write `<=`; {LASTING}`historically[<= 3 s] p`"),
    ("once[at least 3 s] p", "least", "for `at least` write `[>= 3 s]`"),
    ("once[at most 2 steps] p", "most", "for `at most` write `[<= 2 steps]`"),
    ("□ p", "□", "write `always` or `G`"),
    ("◇ p", "◇", "write `eventually` or `F`"),
    ("○ p", "○", "write `next` or `X`"),
    ("p OR q", "OR", "write `or` or `|`"),
    ("p Until q", "Until", "write `until` or `U`"),
    ("nevr p", "p", "did you mean `never`?"),
    ("onse p", "p", "did you mean `once`?"),
    ("eventualy f", "f", "did you mean `eventually`?"),
    ("p sinc q", "sinc", "did you mean `since`?"),
    ("p than q", "than", "did you mean `then`?"),
    ("p and then q", "then", "`then` alone separates two phases: write `p then q`"),
    ("if not p then q", "if", "write `p implies q` for `if p then q`"),
    ("⧫ p", "⧫", "write `once` or `O`"),
    ("Previously p", "p", "did you mean `previously`?"),
    ("GHp p", "p", OF_AN_OBJECT.format("GHp(p)")),
    ("OH p", "p", "`OH` is read as one name; write `O H`"),
    # Bounds.
    ("always[3] p", "]", "say what it counts: `3 s` or `3 steps`"),
    ("always[< 3 s] p", "<", "a bound includes its end: write `[<= 3 s]`"),
    ("O[> 3 s] p", ">", "a bound includes its end: write `[>= 3 s]`"),
    ("p U[= 3 s] q", "=", "for exactly that time write `[3 s]`"),
    ("p since[3 s, 4 s] q", ",", TWO_ENDS),
    ("p then[3 s to 4 s] q", "to", TWO_ENDS),
    ("always[3..4 s] p", "..", BOTH_UNITS.format("[3 s .. 4 s]")),
    ("always[1-3 s] p", "1-3", BOTH_UNITS.format("[1 s .. 3 s]")),
    ("always[<= 0,5 s] p", ",", "write a point: `0.5`"),
    ("always[<= three seconds] p", "seconds", "write the number in digits: `3 seconds`"),
    ("speed < seven km/h", "km", "write the number in digits: `7` for `seven`"),
    ("not p always", "always", "it comes before what it is about: `always p`"),
    (
        "always (v: car) near(v)",
        ":",
        "write `every v: car (…)` or `some v: car (…)`, or declare it after the rule's name",
    ),
    ("always[3 s <=] p", "<=", "the sign comes before the time: `[<= 3 s]`"),
    ("p and eventualy[<= 3 s] q", "[", "did you mean `eventually`?"),
    ("speed is less than 50 km/h", "is", "for `is less than` write `<`"),
    ("speed is below 50 km/h", "is", "for `is below` write `<`"),
    ("the driver stops", "driver", f"{BETWEEN_WORDS}, `or` or `implies`; a name is one word"),
    ("ahead_of v", "v", OF_AN_OBJECT.format("ahead_of(v)")),
    ("always[3 s ..] p", "]", "without an upper end write `[>= 3 s]`"),
    ("always[.. 3 s] p", "..", "without a lower end write `[<= 3 s]`"),
    ("always[3 s p", "p", "close the bound with `]`"),
    ("always[<= 3 s .. 4 s] p", "..", BOUNDS),
    ("always[3 s + 1 s] p", "+", BOUNDS),
    (
        "once[<= -3 s] p",
        "-",
        "a bound counts forward, or back for `once` and its family: it has no sign",
    ),
    ("not[<= 3 s] p", "[", OVER_TIME),
    ("p and[<= 3 s] q", "[", OVER_TIME),
    ("[<= 3 s] p", "[", BEHIND),
    ("always (p)[<= 3 s]", "[", BEHIND),
    ("always <= 3 s p", "<=", "a bound goes in brackets, such as `always[<= 3 s]`"),
    ("p within 3 s", "within", "write `eventually[<= 3 s] p`, or `once[<= 3 s] p` of the past"),
    ("within 10 s p", "10", "write `eventually[<= 10 s] p`, or `once[<= 10 s] p` of the past"),
    # Comparisons and arithmetic.
    ("a < b < c", "<", "compare two at a time: write `a < b and b < c`"),
    (
        "p or 0 m < gap(v, w) <= 5 m and q",
        "<=",
        "compare two at a time: write `0 m < gap(v, w) and gap(v, w) <= 5 m`",
    ),
    ("a + b = c = d", "=", "compare two at a time: write `a + b = c and c = d`"),
    ("a =< b", "=<", "write `<=`"),
    ("gap => 3 m", "=>", "write `>=` for at least; `=>` would be `implies`"),
    ("a <> b", "<>", "write `!=`"),
    ("a =! b", "!", "write `!=`"),
    ("a ≤ b", "≤", "write `<=`"),
    ("a × b > 3", "×", "write `*`"),
    ("a ** 2 > 3", "**", "powers cannot be written; arithmetic is linear"),
    ("> 3", ">", "say what is compared, such as `speed <= 50 km/h`"),
    ("speed 3 m", "3", BY_SIGNS),
    ("gap(v) 1.5 m", "1.5", BY_SIGNS),
    ("gap < 1,5 m", ",", "write a point: `1.5`"),
    ("gap < 1.000,5 m", ",", "write a point: `1000.5`"),
    ("gap < .5 m", ".", "write `0.5`"),
    ("sp\u00adeed > 3", "\u00ad", "delete the character there, which cannot be seen"),
    ("gap < 1 000 m", "000", DIGITS),
    ("gap < 1'000 m", "'", DIGITS),
    ("gap < 1_000 m", "m", DIGITS),
    ("gap > 2 s speed", "speed", "write `s * speed` for a product"),
    ("gap > +3 m", "+", "delete the `+`"),
    # Conditionals.
    (
        "gap > 1.5 m if town else 2 m",
        "if",
        "a conditional goes in parentheses: `(1.5 m if built_up else 2 m)`",
    ),
    (
        "gap > (1.5 m if town)",
        ")",
        "a conditional ends with what holds otherwise: `1.5 m if built_up else 2 m`",
    ),
    ("gap > (3 m if p, 2 m if q else 1 m)", ",", f"{CHAINS}in place of `,`, {AS_IN}"),
    ("gap > (3 m if p 2 m if q else 1 m)", "2", f"{CHAINS}before `2`, {AS_IN}"),
    ("gap > (town ? 1.5 m : 2 m)", "?", CONDITIONAL),
    ("gap > (if town then 1.5 m else 2 m)", "if", CONDITIONAL),
    ("p if q", "if", "write `q implies p` for `p if q`"),
    # Some, every, count.
    ("exists x: T (p)", "x", "write `some x: T (…)`"),
    ("∀ x: T (p)", "∀", "write `every x: T (…)`"),
    ("for all x: T (p)", "all", "write `every x: T (…)`"),
    ("forall x in T (p)", "x", "write `every x: vehicle (…)`"),
    ("some x in T (p)", "in", "it is written `some x: vehicle (…)`"),
    (
        "some x: T p(x)",
        "p",
        "what is said about it goes in parentheses: `some x: vehicle (…)`",
    ),
    ("some x: T", "", "what is said about it goes in parentheses: `some x: vehicle (…)`"),
    ("count(x: T (p)) > 2", "(", "it is written `count x: vehicle (…)`"),
    ("every x, y: T (p)", ",", f"{ONE_VARIABLE}`every x: T (every y: T (…))`"),
    ("every x: T, y: T (p)", ",", f"{ONE_VARIABLE}`every x: T (every y: T (…))`"),
    # Arguments and what joins formulas.
    ("p(q(v))", "(", "an argument is a name; it has no arguments of its own"),
    (
        "nie (q(v) und p)",
        "nie",
        "if it is meant for a name, an argument is a name; it has no arguments of its own",
    ),
    ("nevr (p(v) and q)", "nevr", "did you mean `never`?"),
    ("alwais (p and q)", "alwais", "did you mean `always`?"),
    ("p(v w)", "w", "separate the names by `,`"),
    ("p()", ")", "without arguments there are no parentheses"),
    ("p(1)", "1", NAMES),
    (
        "speed <= min(limit, 50 km/h)",
        "50",
        f"{NO_FUNCTION} `min`: compare {ONE_BY_ONE} and x <= b`",
    ),
    ("gap >= max(3 m, gap)", "3", f"{NO_FUNCTION} `max`: compare {ONE_BY_ONE} or x <= b`"),
    # What other languages have.
    ("ego.speed > 3 m/s", ".", "what is about ego is written alone: `speed`"),
    ("v.speed > 3 m/s", ".", "what is of an object is written `speed(v)`"),
    ("place(v) in {left, right}", "in", f"{BY_ITSELF} `left(v) or right(v)`"),
    ("place in (left, right)", "in", f"{BY_ITSELF} `left or right`"),
    ("gap in 3 m .. 4 m", "in", "write `a <= x and x <= b`"),
    ('speed <= "50 km/h"', '"50 km/h"', "write `50 km/h` without quotes"),
    ("p for at least 3 s", "for", "for how long is written as a bound, such as `always[<= 3 s] p`"),
    (
        "speed < previous speed",
        "speed",
        "numbers of earlier states cannot be read; formulas can: `previously (speed > 0)`",
    ),
    ("(when p then q)", "when", f"{IN_A_FORMULA} `p implies q`; {A_CLAUSE}"),
    ("(unless p then q)", "unless", f"{IN_A_FORMULA} `not p implies q`; {A_CLAUSE}"),
    ("p, q", ",", OR_AND),
    ("p; q", ";", OR_AND),
    ("{ p }", "{", "a formula goes in parentheses, or alone, but not in braces"),
    ("weak p", "weak", "`weak` comes before `until`, `next` or `previously`"),
    ("p weak since q", "weak", "`weak` comes before `until`, `next` or `previously`"),
    ("p strong until q", "strong", "`strong` comes before `release`"),
    ("(p & q))", ")", "delete the `)`, or open it before"),
    ("p;", ";", "delete the `;`"),
    ("'p'", "'p'", "write `p` without quotes"),
    ("“p”", "“", "write `p` without quotes"),
]


def check(found, underlined, way_out):
    assert found.help == way_out
    place = found.place
    assert place.excerpt[place.column - 1 : place.end_column - 1] == underlined


@pytest.mark.parametrize(("text", "underlined", "way_out"), FORMULAS)
def test_in_a_formula(text, underlined, way_out):
    with pytest.raises(RulecError) as caught:
        parse_formula(text)
    (one,) = caught.value.diagnostics
    check(one, underlined, way_out)


HEAD = "a rule's head is written `hard rule NAME (v: vehicle) in LEVEL weight NUMBER`"
SCOPES = "a scope is `initially`, `at start`, `throughout`, `at some point`, or `at end`"
ONE_VALUE = "a state gives a quantity one value, such as `speed = 50 km/h`"
LINES = [
    ("hard rule a { require p accept { x = –5 m } }", "–", "write `-`"),
    ("hard rule a { require x < —5 m }", "—", "write `-`"),
    (
        "hard rule a { require p accept { p(v) = true } }",
        "true",
        "what is true is said without `=`, such as `p(v)`, what is not as `not p(v)`",
    ),
    (
        "hard rule a { re\u00adquire p }",
        "re",
        "after `re`, delete the character there, which cannot be seen",
    ),
    ("title 'A'", "'A'", 'texts go in straight double quotes: "…"'),
    ('title = "A"', "=", "delete the `=`"),
    ('title: "A"', ":", "delete the `:`"),
    ("title A", "A", 'put the text in double quotes: "…"'),
    ("law «A»", "«", 'texts go in straight double quotes: "…"'),
    ("signal p q", "q", "separate the names by `,`"),
    ("signal p; q", ";", "separate the names by `,`"),
    (
        "signal p default 1",
        "1",
        "a signal is true or false: write `default true` or `default false`",
    ),
    ("x is a, b", "a", "the values follow `is one of`, such as `is one of a, b`"),
    ("x is one of a or b", "or", "separate the names by `,`"),
    ("sgnal p", "sgnal", "did you mean `signal`?"),
    ("import p", "import", "write `use NAME`"),
    ("use paper, road", ",", "write a `use` line for each vocabulary"),
    ("use my words", "words", "a name is one word, such as `my_words`"),
    ('law "A" 2020', "2020", 'the line is written `law "…"` or `law "…" as of 2006-03-28`'),
    ("hard rule no-u { require p }", "-", f"{NAMES}, such as `no_u`"),
    ('hard rule "A" { require p }', '"A"', "write `A` without quotes"),
    ('hard rule "Too fast!" { require p }', '"Too fast!"', f"{NAMES}, such as `too_fast`"),
    ('hard rule "§ 5" { require p }', '"§ 5"', f"{NAMES}; its article is said by `cite`"),
    ("// why", "//", "a comment begins with `#`"),
    ("hard rule a { require p accept { p for 3 s } }", "for", AS_OFTEN),
    ("hard rule a { require p accept { 3 x (not p) } }", "3", AS_OFTEN),
    ("hard rule a { p -> q }", "p", "a formula follows `require`"),
    ("colour", "colour", "an enumeration is declared by `colour is one of a, b`"),
    ("hard a { require p }", "a", "write `hard rule a`"),
    ("soft a { require p }", "a", "write `soft rule a`"),
    (
        "rule a { require p }",
        "rule",
        "write `hard rule a`, or `soft rule` for one that may yield",
    ),
    ("sotf rule a { require p }", "sotf", "did you mean `soft`?"),
    (
        "hard rule a (v car) { require p }",
        "car",
        "a variable is written with its type, such as `v: vehicle`",
    ),
    (
        "hard rule a (v: car w: car) { require p }",
        "w",
        "separate the variables by `,`",
    ),
    ("hard rule a:", ":", "what a rule says goes between `{` and `}`"),
    ("hard rule a () { require p }", ")", "a rule without variables has no parentheses"),
    ("hard rule a { require p accept { gap = 1,5 m } }", ",", "write a point: `1.5`"),
    (
        "hard rule a { require p certainty from memory }",
        "from",
        "what was written from memory is `unverified`; `source` says in words where from",
    ),
    (
        "hard rule a (every v: car) { require p }",
        "every",
        "leave `every` out: a rule holds for every one, as in `(v: vehicle)`",
    ),
    (
        "hard rule a (v: car, some w: car) { require p }",
        "some",
        "a rule holds for every one; of some speaks its formula: `some v: vehicle (…)`",
    ),
    (
        "hard\u200b rule a { require p }",
        "\u200b",
        "delete the character there, which cannot be seen",
    ),
    (
        "hard rule a { require p accept { p, q } }",
        ",",
        "states are separated by `;`, the facts of one state by `and`",
    ),
    (
        "hard rule a { require p accept { p or q } }",
        "or",
        "a state says what holds; for another possibility write another example",
    ),
    (
        "hard rule a { require p accept { p; X q } }",
        "X",
        "a state holds atoms and `not` before a signal; no other operator",
    ),
    (
        "hard rule a { require p accept { p then q } }",
        "then",
        "a state holds atoms and `not` before a signal; no other operator",
    ),
    (
        "hard rule a { require p accept { p; O q } }",
        "O",
        "a state holds atoms and `not` before a signal; no other operator",
    ),
    (
        "hard rule a { require p accept { p; } }",
        "",
        "say what holds in this state; a `;` only separates two states",
    ),
    ('hard rule a { require p says "a "b" c" }', "b", 'a quote inside a text is written \\"'),
    ("hard rule a { require p; }", ";", "delete the `;`"),
    ("hard rule a { require p\nsay 'no' }", "say", "did you mean `says`?"),
    # Header lines and what a rulebook does to the one that it extends.
    ('extends "vienna"', '"vienna"', "write `vienna` without quotes"),
    ("traffic near", "near", FORMS["traffic"]),
    ("semantics ltlf", "ltlf", FORMS["semantics"]),
    ("semantics infinite", "infinite", FORMS["semantics"]),
    ("step = 0.5 s", "=", FORMS["step"]),
    ("priority a < b", "<", "the more important one comes first: write `b > a`"),
    ("drop x", "x", FORMS["drop"]),
    ("drop rule x", "", FORMS["drop"]),
    ('drop rule because "y"', "because", FORMS["drop"]),
    ("drop rule x because y", "y", 'put the text in double quotes: "…"'),
    ('remove rule x because "y"', "remove", 'write `drop rule x because "…"`'),
    ('soften rule x because "y" weight 2', "weight", FORMS["soften"]),
    ("silent x", "x", FORMS["silent"]),
    ('silent on rule x because "y"', "rule", FORMS["silent"]),
    # Options, parameters, definitions.
    ("option x = true", "true", "write `on`"),
    (
        "fact (v: car) near(v)",
        ":",
        "leave the variables' types out: a fact is about all objects that fit its words",
    ),
    ("option x on", "on", FORMS["option"]),
    ("param x 3 m", "3", FORMS["param"]),
    ("param x := 3 m", ":=", "write `=` for `:=`"),
    ("param x = 3 m from 2020-04-01", "from", IN_FORCE),
    ("param x = 3 m in force 2020-04-01", "2020-04-01", IN_FORCE),
    (
        "param x = 3 m in force from 1.4.2020",
        "1.4.2020",
        "a date is written year-month-day: `2020-04-01`",
    ),
    ("set x to on", "to", "write `=` for `to`"),
    ("set x = on in force from 2027-01-01", "in", NO_DATES),
    ("option x = off in force", "in", NO_DATES),
    (
        "define f(x) { p }",
        "{",
        "write `=` before the formula, and no braces: `define NAME = formula`",
    ),
    ("define f(x): p", ":", "write `=` for `:`"),
    ("define f(x) =", "", FORMS["define"]),
    ("function f(x) = p", "function", "write `define NAME = formula`"),
    ("quantity x in m default 3 m", "m", "the number is in the quantity's own unit: `default 3`"),
    ("type car extends vehicle", "extends", FORMS["type"]),
    # Rules.
    ("override x { require p }", "x", "write `override rule x`"),
    ("override hard x { require p }", "x", "write `override hard rule x`"),
    ("hard override rule x {}", "override", "`override` comes first: `override hard rule`"),
    ("hard rule a weight 2 in b { require p }", "in", HEAD),
    ("hard rule a { require p unless q at the end }", "at", SCOPES),
    ("hard rule a { require p unless q at any point }", "at", SCOPES),
    ("hard rule a { require p unless q during }", "during", SCOPES),
    ("hard rule a { require p unless q throught }", "throught", "did you mean `throughout`?"),
    (
        "hard rule a { require p unless throughout q }",
        "throughout",
        "the scope follows the formula, such as `unless p throughout`",
    ),
    ("hard rule a { require p except q }", "except", "an exception is written `unless formula`"),
    ("hard rule a { require p from 2020-01-01 }", "from", IN_FORCE),
    ("hard rule a { require p\nin froce from 2020-01-01 }", "froce", "did you mean `force`?"),
    ("hard rule a { require: p }", ":", "delete the `:`"),
    # What other languages have, and this one has not.
    ("signal p;", ";", "delete the `;`"),
    ("type car;", ";", "delete the `;`"),
    ("use paper.", ".", "delete the `.`"),
    ("hard rule a { require p accept { p }; }", ";", "delete the `;`"),
    ("state light is red, green", "state", "write `x is one of a, b`"),
    ("float gap", "float", "write `quantity NAME in UNIT`"),
    ("class car", "class", "write `type NAME`"),
    ("hard rule a { must p }", "must", "what must hold is written `require formula`"),
    (
        "hard rule a { forbid p }",
        "forbid",
        "what is forbidden is written `require never (formula)`",
    ),
    (
        'hard rule a { cite "1"\n  if p then q }',
        "if",
        "write `require always (p implies q)` for `if p then q`",
    ),
    ('hard rule a { says "1"\n  if p }', "if", "a condition is written `when formula`"),
    (
        "hard rule a { require p\nexample { p } }",
        "example",
        "an example is written `accept { … }` or `reject { … }`",
    ),
    ('hard rule a { require p\narticle "1" }', "article", 'write `cite "…"`'),
    ('hard rule a { require p\ndescription "1" }', "description", 'write `says "…"`'),
    ("hard rule a { require p; unless q }", ";", "delete the `;`"),
    ("hard rule a { require p unless q\n  at the end }", "at", SCOPES),
    ("gap = 3 m", "gap", "write `param gap = …` or `define gap = …`"),
    ("hard rule a { require p accept { v > 3 m } }", ">", ONE_VALUE),
    ("hard rule a { require p accept { v 3 m } }", "3", ONE_VALUE),
    (
        "hard rule a { require p accept { v = w } }",
        "w",
        "a quantity gets a number, such as `speed = 50 km/h`; for a value write only `w`",
    ),
    (
        "hard rule a { require p accept { q and p = true } }",
        "true",
        "write `p` for true and `not p` for false, without `=`",
    ),
    (
        "hard rule a { require p accept { not v = 3 m } }",
        "=",
        "a quantity has one value in a state; write `=` without `not`",
    ),
    (
        'hard rule a { require p accept (v: T) "x" { p } }',
        '"x"',
        'the label comes before the objects: `accept "…" (v: vehicle)`',
    ),
]


@pytest.mark.parametrize(("line", "underlined", "way_out"), LINES)
def test_in_a_line(line, underlined, way_out):
    text = f"rulebook a\n{line}\nhard rule last {{ require p }}\n"
    _, (one,) = parse(Source("a.rules", text))
    check(one, underlined, way_out)


def test_what_cannot_be_seen_is_called_by_its_number():
    for text in ("rulebook a\n\ufefftitle 'A'\n", "rulebook a\nsignal p\u200b, q\n"):
        _, (one, *_) = parse(Source("a.rules", text))
        assert one.message.endswith((" with `U+FEFF`", " with `U+200B`"))


EXPECTED = [
    ("p and", "expected an atom, a number, `not`, or `(`"),
    ("p q", "expected an operator such as `and`"),
    ("(p", "expected `)` or an operator such as `and`"),
    ("", "expected an atom, a number, `not`, or `(`"),
    ("always[<= 3 s", "expected `]`"),
    ("always[", "expected a name, a number, `<=`, or `>=`"),
    ("p U", "expected an atom, a number, `not`, or `(`"),
    ("speed >", "expected a name, a number, or `(`"),
    ("gap >= 2 s *", "expected a name, a number, or `(`"),
    ("count x", "expected `:`"),
    ("(2 m if p", "expected `else` or an operator such as `and`"),
]


@pytest.mark.parametrize(("text", "expected"), EXPECTED)
def test_what_was_expected_is_said_in_words(text, expected):
    with pytest.raises(RulecError) as caught:
        parse_formula(text)
    (one,) = caught.value.diagnostics
    assert one.expected == expected
    assert one.place.column == len(text) + 1 or text == "p q"


def test_an_open_parenthesis_is_shown():
    with pytest.raises(RulecError) as caught:
        parse_formula("(p) & (q -> (r)")
    (label,) = caught.value.diagnostics[0].labels
    assert label.place.column == 7
