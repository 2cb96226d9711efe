"""The canonical form of single files: what is kept, what goes, where lines end."""

from pathlib import Path

import pytest

from rulec.diagnostics import RulecError, Source
from rulec.resources import rulebooks_folder
from rulec.rulebook.template import new_rulebook
from rulec.syntax import decode
from rulec.syntax.formatting import format_source

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = sorted(rulebooks_folder().rglob("*.rules"))


def formatted(text):
    return format_source(Source("test", text))


def clause(text):
    """A clause in its canonical form; its rule is written on several lines."""
    head, end = "rulebook b\n\nhard rule r {\n", "}\n"
    whole = formatted(f"{head}{text}\n{end}")
    assert whole.startswith(head)
    assert whole.endswith(end)
    return whole[len(head) : -len(end)]


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_what_ships_is_in_canonical_form(path):
    text = path.read_text(encoding="utf-8")
    assert formatted(text) == text


def test_what_new_writes_is_in_canonical_form():
    from datetime import date

    text = new_rulebook("fresh", date(2026, 1, 1))
    assert formatted(text) == text


@pytest.mark.parametrize(
    "path",
    sorted((ROOT / "tests" / "programs" / "good").glob("*.rules")),
    ids=lambda path: path.stem,
)
def test_good_programs_keep_their_meaning(path):
    assert format_source(decode(path.name, path.read_bytes()))


def test_mistakes_are_the_answer():
    with pytest.raises(RulecError) as caught:
        formatted("rulebook b\nsignal p q\nhard rule r { require p p }\n")
    assert [one.code for one in caught.value.diagnostics] == ["R0104", "R0104"]


def test_everything_on_one_line():
    assert formatted(
        'rulebook b title "T" law "L"  as of 2020-02-29 use paper extends a semantics finite '
        "signal p,q(o:car)default false hard   rule r(v:car)in legal weight 2{require p}"
    ) == (
        "rulebook b\n"
        'title   "T"\n'
        'law     "L" as of 2020-02-29\n'
        "use     paper\n"
        "extends a\n"
        "semantics finite\n"
        "signal p, q(o: car) default false\n"
        "hard rule r (v: car) in legal weight 2 { require p }\n"
    )


def test_provisions_and_declarations():
    text = formatted(
        "rulebook b extends a priority safety>legal=other type c is d s(o)is one of x,y default x "
        "quantity g(o:c)in km/h default-1.5 option o=on "
        "param w:speed=7km/h in force from 2020-01-01 until 2021-01-01 set w=-2 m/s set o=off "
        'define f(v:c,side)=side(v)and p redefine g=p drop rule r because "B" '
        'soften rule s in legal weight 2 because "B" silent on zip because "B" '
    )
    assert text.splitlines() == [
        "rulebook b",
        "extends a",
        "priority safety > legal = other",
        "type c is d",
        "s(o) is one of x, y default x",
        "quantity g(o: c) in km/h default -1.5",
        "option o = on",
        "param  w : speed = 7 km/h in force from 2020-01-01 until 2021-01-01",
        "set    w = -2 m/s",
        "set    o = off",
        "define f(v: c, side) = side(v) and p",
        "redefine g = p",
        'drop   rule r because "B"',
        'soften rule s in legal weight 2 because "B"',
        'silent on zip because "B"',
    ]


@pytest.mark.parametrize(
    ("written", "canonical"),
    [
        ("G!( a&&X( b U[<=3s]c ) )", "G !(a && X(b U[<= 3 s] c))"),
        ("[] ( a )|<>b||F(b)", "[] a | <> b || F b"),
        ("weak   next(a) U b strong\n  release c", "weak next a U b strong release c"),
        ("((a and b))", "a and b"),
        ("((a and b)) or (c)", "(a and b) or c"),
        ("a and (b and c)", "a and (b and c)"),
        ("always[1s..4 s](a)", "always[1 s .. 4 s] a"),
        ("next[ 2 steps ] a", "next[2 steps] a"),
        ("g(v)<1.5m+2*-h", "g(v) < 1.5 m + 2 * -h"),
        ("count x:car((p(x)))>=8", "count x: car (p(x)) >= 8"),
        ("g < ((1 m if p else 2 m))", "g < (1 m if p else 2 m)"),
        ("(1 m if p else 2 m)", "(1 m if p else 2 m)"),
        ("2 m/s = 2 m / s", "2 m/s = 2 m / s"),
    ],
)
def test_formulas(written, canonical):
    assert clause(f"require {written}") == f"  require {canonical}\n"


@pytest.mark.parametrize(
    ("written", "shown"),
    [
        ("always (p) implies q", "(always p) implies q"),
        ("never (p) and q", "(never p) and q"),
        ("always (some x: c (r(x))) and p", "(always some x: c (r(x))) and p"),
        ("always ((p or q)) and q", "always (p or q) and q"),
    ],
)
def test_redundant_parentheses_do_not_hide_what_could_be_misread(written, shown):
    assert clause(f"  require {written}\n") == f"  require {shown}\n"


def test_parentheses_before_a_scope_stay():
    text = "  require a\n  unless  (a or b) at some point\n"
    assert clause(text) == text


def test_words_make_columns_where_no_blank_line_parts_them():
    assert clause(
        'cite "A" certainty verified\n in force from 2020-01-01 require p\n\naccept {p}'
    ) == (
        '  cite    "A"\n'
        "  certainty verified\n"
        "  in force from 2020-01-01\n"
        "  require p\n"
        "\n"
        "  accept { p }\n"
    )


def test_what_is_too_long_breaks_at_the_loosest_operators():
    a, b, c, d = ("a" * 25, "b" * 25, "c" * 25, "d" * 25)
    assert clause(f"require {a} or {b} and {c} implies {d}") == (
        f"  require {a} or {b} and {c}\n          implies {d}\n"
    )
    assert clause(f"require {a} or {b} and {c} and {d}") == (
        f"  require {a}\n          or {b} and {c} and {d}\n"
    )
    assert clause(f"require {d} implies {a} and {b} and {c} and {a}") == (
        f"  require {d}\n"
        f"          implies {a}\n"
        f"            and {b}\n"
        f"            and {c}\n"
        f"            and {a}\n"
    )
    assert clause(f"require G({a} & X({b} U {c}xxxx))") == (
        f"  require G(\n            {a} & X({b} U {c}xxxx)\n          )\n"
    )


def test_line_ends_of_the_author_go_where_the_line_is_long_enough():
    assert clause("require a\n    and b\n    and c") == "  require a and b and c\n"


def test_a_definition_stays_on_lines_of_its_own():
    rule = "\n\nhard rule r {\n  require p\n}\n"
    for text in ("define f =\n  p or q", "define f = p or q"):
        whole = f"rulebook b\n{text}{rule}"
        assert formatted(whole) == whole


def test_examples_stay_on_one_line_or_have_a_line_for_each_state():
    one = "  require p\n  accept  { p; q }\n"
    assert clause(one) == one
    many = "  require p\n  accept  {\n    p;\n    q\n  }\n"
    assert clause("require p accept { p;\nq }") == many
    long = f"{'p' * 50} and {'q' * 20}"
    assert clause(f"require p\n\naccept {{ {long}; {long} }}") == (
        f"  require p\n\n  accept {{\n    {long};\n    {long}\n  }}\n"
    )


def test_braces_below_one_another_stay_so():
    text = '  accept "a"   { p }\n  accept "abc" { p }\n\n  require p\n'
    assert clause(text) == text
    assert clause(text.replace('"a"   {', '"a"     {').replace('"abc" {', '"abc"   {')) == text
    apart = text.replace('"a"   {', '"a" {')
    assert clause(apart) == apart


def test_a_long_list_of_signals():
    names = [f"signal_number_{number}" for number in range(9)]
    text = formatted(f"rulebook b signal {', '.join(names)} hard rule r {{ require p }}")
    assert text.splitlines()[1:3] == [
        f"signal {', '.join(names[:5])},",
        f"       {', '.join(names[5:])}",
    ]


def test_texts_are_never_parted_from_their_words():
    text = f'  says    "{"x" * 120}"\n  require p\n'
    assert clause(text) == text
    reason = "x" * 80
    whole = f'rulebook b\nextends a\n\ndrop rule some_rule\n     because "{reason}"\n'
    assert formatted(whole.replace("\n     because", " because")) == whole


def test_options_and_what_is_done_to_others_share_the_header_s_column():
    text = (
        "rulebook b\n"
        "extends a\n"
        "set     o = on\n"
        "param   gap : length = 1.5 m\n"
        'drop    rule r because "B"\n'
        "signal p\n"
        "set w = 1\n"
    )
    assert formatted(text) == text


def test_blank_lines():
    assert formatted(
        "\n\nrulebook b\nsignal p\n\n\n\nsignal q\n# about r\nhard rule r {\n\n\nrequire p\n\n}"
        "\nhard rule s { require p }\nhard rule t { require q }\nhard rule u {\n require p }\n\n\n"
    ) == (
        "rulebook b\nsignal p\n\nsignal q\n\n# about r\nhard rule r {\n  require p\n}\n\n"
        "hard rule s { require p }\nhard rule t { require q }\n\nhard rule u {\n  require p\n}\n"
    )


def test_vocabularies():
    assert formatted("vocabulary v{}") == "vocabulary v {}\n"
    assert formatted("vocabulary v # a\n { # b\n type x # c\n\n\n# d\n\n} # e\n# f") == (
        "vocabulary v {  # a\n  # b\n  type x  # c\n\n  # d\n}  # e\n# f\n"
    )


COMMENTED = """\
# one

rulebook b  # two
# three
title "T"  # four

# five

# six
hard rule r (v: car) {  # seven
  # eight
  require a  # nine
          # ten
          and b
          and (  # eleven
            c
            # twelve
            or d
          )

  # thirteen
  accept {  # fourteen
    a;  # fifteen
    # sixteen
    b
    # seventeen
  }
  # eighteen
}  # nineteen

# twenty
signal p,  # twenty-one
       q
# twenty-two
"""


def test_comments_stay_with_what_they_are_about():
    assert formatted(COMMENTED) == COMMENTED
    untidy = COMMENTED.replace("  #", "#").replace("          ", " ").replace("\n\n", "\n\n\n\n")
    assert formatted(untidy) == COMMENTED


def test_comments_where_no_line_can_end_come_behind():
    assert clause("require b(v # one  \t\n  # two\n  ) # three\n and c") == (
        "  require b(v)  # one\n          # two\n          # three\n          and c\n"
    )


def test_columns_of_comments_stay_columns():
    lines = ("rulebook b", "signal long_name", "", "hard rule r {", "  require p", "}", "signal q")

    def commented(width, gap):
        return "".join(
            f"{line}\n" if len(line) in (0, 1, 13) else f"{line:{width}}{gap}# {line}\n"
            for line in lines
        )

    assert formatted(commented(40, " ")).replace("\n\nsignal q", "\nsignal q") == commented(
        16, "  "
    )
    assert formatted(commented(1, "   ")).replace("\n\nsignal q", "\nsignal q") == commented(
        1, "  "
    )


def test_a_column_of_comments_is_given_up_where_it_does_not_fit():
    long = f"# {'x' * 80}"
    text = f"rulebook b  {long}\nsignal {'p' * 30}  # y\n\nhard rule r {{\n  require p\n}}\n"
    column = text.replace("rulebook b  ", f"{'rulebook b':37}  ")
    assert formatted(column) == text


def test_the_provision_of_a_number_stands_beside_it_or_below():
    long = "s. 4(2) of the by-laws that the council of the island gave itself, as amended"
    assert formatted(
        "rulebook b\nuse road\n"
        'set reaction_time=1.5 s\n  cite "s. 4"\n'
        f'set full_braking = 6 m/s^2 cite "{long}"\n'
        'option tight = on cite   "s. 3"\n'
        "# why\ndefine quick = speed > 100 km/h # so fast\n"
        '# below\ncite "s. 5" # read\n'
    ) == (
        "rulebook b\nuse    road\n"
        'set    reaction_time = 1.5 s cite "s. 4"\n'
        "set    full_braking = 6 m/s^2\n"
        f'  cite "{long}"\n'
        'option tight = on cite "s. 3"\n'
        "# why\ndefine quick = speed > 100 km/h  # so fast\n"
        '  # below\n  cite "s. 5"  # read\n'
    )
