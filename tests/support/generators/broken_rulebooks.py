"""A good rulebook as a list of parts, each with ways to get it wrong by exactly one mistake."""

from dataclasses import dataclass

from hypothesis import strategies as st


@dataclass(frozen=True)
class Part:
    """A line of the file, and wrong spellings of it."""

    right: str
    wrong: tuple[str, ...] = ()


HEADER = [
    Part("rulebook book"),
    Part('title "A book"', ("title A book", "title 'A book'", 'title "A book', 'titel "A book"')),
    Part(
        'law "Act" as of 2020-02-29',
        (
            'law "Act" as of 2021-02-29',
            'law "Act" as 2020-02-29',
            "law Act as of 2020-02-29",
            'law "Act" as of 29.2.2020',
            'law "A\\ct" as of 2020-02-29',
        ),
    ),
    Part("use paper"),
    Part(
        "type truck is vehicle",
        ("type truck vehicle", "type is vehicle", "type truck is", "typ truck is vehicle"),
    ),
    Part(
        "signal p, q(v: vehicle) default false",
        (
            "signal p q(v: vehicle) default false",
            "signal p, q(v: vehicle) default 0",
            "signal p, q(v vehicle) default false",
            "signal p, q(v: vehicle default false",
            "signal , p, q(v: vehicle) default false",
            "singal p, q(v: vehicle) default false",
            "signal p, until, q(v: vehicle) default false",
        ),
    ),
    Part(
        "mode(v: vehicle) is one of slow, fast default slow",
        (
            "mode(v: vehicle) is of slow, fast default slow",
            "mode(v: vehicle) is one of slow fast default slow",
            "mode(v: vehicle) is one of slow, fast, default slow",
            "mode(v: vehicle) one of slow, fast default slow",
        ),
    ),
]
FOOTER = [Part("signal last", ("signal last default", "signal X", "signal last;"))]


def rule_parts(number):
    name = f"R{number}"
    return [
        Part(
            f"hard rule {name} (v: truck) {{",
            (
                f"hard {name} (v: truck) {{",
                f"rule {name} (v: truck) {{",
                f"hrad rule {name} (v: truck) {{",
                f"hard rul {name} (v: truck) {{",
                f"hard rule {name} (v truck) {{",
                f"hard rule {name} (v: truck {{",
                f"hard rule {name} v: truck {{",
                f"hard rule {name} (v: truck)",
                "hard rule (v: truck) {",
                "hard rule until (v: truck) {",
            ),
        ),
        Part('  cite "Art. 1"', ("  cite Art. 1", '  cite "Art. 1', "  cite", "  ctie 'Art. 1'")),
        Part(
            '  says "A text; with {signs}"',
            ("  says 'A text'", '  says "A text; with {signs}', '  says "A "text""', "  said it"),
        ),
        Part(
            "  require G !(b_v & X(b_v U p)) -> q(v)",
            (
                "  require G !(b_v & X(b_v U p) -> q(v)",
                "  require G !(b_v & X(b_v U p))) -> q(v)",
                "  require G !(b_v & & p) -> q(v)",
                "  require G !(b_v & X(b_v U p)) => q(v)",
                "  require G !(b_v & X(b_v U p)) -> q(v",
                "  require G !(b_v & X(b_v U p)) ->",
                "  require G !(b_v & X(b_v U )) -> q(v)",
                "  require G !(b_v & X(b_v U p)) -> q(v);",
                "  require b_v p",
                "  require b_v then then p",
                "  require G (b_v and then p)",
                "  require once",
                "  require b_v since once until p",
                "  require always[1] p",
                "  require G (b_v[<= 3 s] U p)",
                "  require b_v U[3 s, 4 s] p",
                "  require",
                "  requires p",
                "  require hard -> p",
                "  require 'p'",
                '  require "p"',
                "  require (((((p",
            ),
        ),
        Part(
            "  accept { b_v; l_v and p }",
            (
                "  accept b_v; l_v and p }",
                "  accept { b_v; l_v and p",
                "  accept { b_v, l_v and p }",
                "  accept { b_v; l_v or p }",
                "  accept { b_v; ; l_v and p }",
                "  accept { }",
                "  accept b_v, l_v",
                "  acept { b_v; l_v and p }",
                "  accept { b_v; G p }",
                "  accept { b_v; require }",
            ),
        ),
        Part(
            '  reject "label" { f_v }',
            (
                '  reject "label { f_v }',
                "  reject label { f_v }",
                '  reject "label" { f_v; }',
                '  reject "label" { not not f_v }',
                "  reject 'label' { f_v }",
                '  reject "label" "again" { f_v }',
                '  reject "\\label" { f_v }',
            ),
        ),
        Part("}", ("", "} }")),
    ]


SEMANTIC = [
    ("(v: truck)", "(v: trukc)"),
    ("X(b_v U p)", "X(bb U p)"),
    ("q(v)", "q(w)"),
    ("q(v)", "q"),
    ("q(v)", "mode(v)"),
    ("U p", "U p(v)"),
    ("{ b_v; l_v and p }", "{ b_v; l_v and f_v }"),
    ("{ b_v; l_v and p }", "{ b_v; p }"),
    ("{ b_v; l_v and p }", "{ b_v; not l_v }"),
    ("{ b_v; l_v and p }", "{ b_v; l_v and pp }"),
    ("  require G !(b_v & X(b_v U p)) -> q(v)\n", ""),
]
"""In one good rule: what to replace by what for one mistake of meaning."""


@st.composite
def broken_rulebooks(draw):
    """A text and, for each of its mistakes, the first and the last line to report it at."""
    lines: list[str] = []
    wrong: list[tuple[int, int]] = []

    def write(part, break_it):
        first = len(lines) + 1
        text = draw(st.sampled_from(part.wrong)) if break_it and part.wrong else part.right
        lines.append(text)
        if text is not part.right:
            # A missing brace is reported where the next thing begins, behind an empty line maybe.
            wrong.append((first, first + 2))

    def some(parts):
        broken = draw(st.sets(st.integers(0, len(parts) - 1), max_size=3))
        for position, part in enumerate(parts):
            write(part, position in broken)

    some(HEADER)
    declared = all(first < 5 for first, _ in wrong)
    for number in range(draw(st.integers(1, 4))):
        lines.append("")
        if declared and draw(st.booleans()):
            old, new = draw(st.sampled_from(SEMANTIC))
            text = "\n".join(part.right for part in rule_parts(number)) + "\n"
            assert old in text
            wrong.append((len(lines) + 1, len(lines) + 7))
            lines += text.replace(old, new, 1).rstrip("\n").split("\n")
        else:
            some(rule_parts(number))
    lines.append("")
    some(FOOTER)
    return "\n".join(lines) + "\n", wrong
