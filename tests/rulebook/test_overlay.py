"""Rulebooks that extend others come to what one gets by merging them by hand."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.rulebook.loader import diagnose, parse_rulebook
from rulec.rulebook.reading.rulebook_reader import load_rulebook

DAYS = ["2000-01-01", "2010-01-01", "2020-01-01"]
WORDS = """
signal near, wet default false
quantity gap in m default 0
"""
REQUIRES = [
    "always d0",
    "always (o0 implies d1)",
    "always gap > p0",
    "never (near then d0 then gap < p1)",
    "always (o1 or near)",
]
BODIES = ["near", "not near", "wet and gap > p0", "gap < p1", "o0"]
CLAUSES = {
    "cite": [f'"Art. {number}"' for number in range(3)],
    "says": [f'"It says {number}."' for number in range(3)],
    "source": ['"a law"', '"a court"'],
    "certainty": ["verified", "secondary"],
    "require": REQUIRES,
    "unless": ["wet initially", "near initially"],
    "when": ["wet", "not wet"],
    "in force": ["from 2005-01-01", "until 2015-01-01", "from 2005-01-01 until 2010-01-01"],
    "accept": ['"one" { near }', '"two" { wet; near }'],
}

STAYS = {"require": "always not wet"}


@dataclass
class Book:
    """One rulebook: header lines, and what its items do."""

    header: dict = field(default_factory=dict)
    rules: dict = field(default_factory=dict)
    overrides: dict = field(default_factory=dict)
    confirmed: dict = field(default_factory=dict)
    dropped: list = field(default_factory=list)
    silent: list = field(default_factory=list)
    softened: dict = field(default_factory=dict)
    options: dict = field(default_factory=dict)
    parameters: dict = field(default_factory=dict)
    definitions: dict = field(default_factory=dict)


clauses = st.fixed_dictionaries(
    {}, optional={name: st.sampled_from(texts) for name, texts in CLAUSES.items()}
)
heads = st.fixed_dictionaries(
    {},
    optional={
        "strength": st.sampled_from(["hard", "soft"]),
        "weight": st.sampled_from(["2", "0.5"]),
        "in": st.sampled_from(["safety", "legal"]),
    },
)
values = st.tuples(
    st.sampled_from(["1 m", "2 km", "0"]),
    st.sampled_from(["", "from 2005-01-01", "until 2015-01-01", "from 2012-01-01"]),
)


def some_of(names, what):
    return st.fixed_dictionaries({}, optional=dict.fromkeys(names, what))


@st.composite
def chains(draw):
    """The most general book first."""
    known = ["r0", "r1", "r2"]
    rule = st.tuples(heads, clauses)
    whole = st.tuples(
        heads.map(lambda head: {"strength": "hard", **head}),
        clauses.map(lambda inner: {"require": REQUIRES[0], **inner}),
    )
    header = some_of(["traffic", "semantics", "step"], st.booleans())
    base = Book(
        header=draw(header),
        rules={name: draw(whole) for name in known} | {"stays": ({"strength": "hard"}, STAYS)},
        options=dict.fromkeys(["o0", "o1"], draw(st.booleans())),
        parameters={name: (draw(values)[0], "") for name in ("p0", "p1")},
        definitions={name: draw(st.sampled_from(BODIES)) for name in ("d0", "d1")},
    )
    books = [base]
    for number in range(draw(st.integers(1, 3))):
        book = Book(
            header=draw(header),
            options=draw(some_of(["o0", "o1"], st.booleans())),
            parameters=draw(some_of(["p0", "p1"], values)),
            definitions=draw(some_of(["d0", "d1"], st.sampled_from(BODIES))),
        )
        for name in [*known]:
            match draw(
                st.sampled_from(["keep", "override", "confirm", "drop", "soften", "silent"])
            ):
                case "confirm":
                    book.confirmed[name] = ({}, {"cite": draw(st.sampled_from(CLAUSES["cite"]))})
                case "override":
                    book.overrides[name] = draw(rule)
                case "drop":
                    book.dropped.append(name)
                case "soften":
                    book.softened[name] = draw(st.sampled_from(["3", "0.25"]))
                case "silent":
                    book.silent.append(name)
        known = [one for one in known if one not in (*book.dropped, *book.silent)]
        for name in draw(st.sets(st.sampled_from([f"n{number}", *book.dropped]))):
            book.rules[name] = draw(whole)
            known.append(name)
        books.append(book)
    return books


def rule_text(name, head, inner, verb=""):
    strength = head.get("strength", "")
    place = f" in {head['in']}" if "in" in head else ""
    weight = f" weight {head['weight']}" if "weight" in head else ""
    said = "\n".join(f"  {clause} {text}" for clause, text in inner.items())
    return f"{verb} {strength} rule {name}{place}{weight} {{\n{said}\n}}"


def header_text(header):
    sides = {True: "left", False: "right"}
    ends = {True: "finite", False: "stutter"}
    steps = {True: "0.5 s", False: "2 s"}
    shown = {"traffic": sides, "semantics": ends, "step": steps}
    return "\n".join(f"{word} {shown[word][value]}" for word, value in header.items())


def parameter_text(value):
    number, dates = value
    return f"{number} in force {dates}" if dates else number


def book_text(book, number):
    lines = [f"rulebook b{number}"]
    lines += [f"extends b{number - 1}"] if number else ["priority safety > legal"]
    lines += [header_text(book.header)]
    lines += [] if number else [WORDS]
    # What is dropped may be there again under the same name, in this order.
    lines += [f'drop rule {name} because "gone"' for name in book.dropped]
    lines += [f'silent on {name} because "no word"' for name in book.silent]
    lines += [f"soften rule {name} weight {weight}" for name, weight in book.softened.items()]
    verb = "set" if number else "option"
    lines += [f"{verb} {name} = {'on' if on else 'off'}" for name, on in book.options.items()]
    for name, value in book.parameters.items():
        start = f"set {name}" if number else f"param {name} : length"
        lines.append(f"{start} = {parameter_text(value)}")
    verb = "redefine" if number else "define"
    lines += [f"{verb} {name} = {body}" for name, body in book.definitions.items()]
    lines += [rule_text(name, *rule) for name, rule in book.rules.items()]
    lines += [rule_text(name, *rule, "override") for name, rule in book.overrides.items()]
    lines += [rule_text(name, *rule, "confirm") for name, rule in book.confirmed.items()]
    return "\n".join(lines)


def in_force(dates, day):
    words = dates.split()
    begin = words[1] if words[:1] == ["from"] else ""
    end = words[-1] if "until" in words else "9999"
    return begin <= day <= end


def merged_by_hand(books, day):
    """One book without bases that says the same; the steps, books and laws of its rules."""
    header, rules, steps, owners, laws = {}, {}, {}, {}, {}
    options, parameters, definitions = {}, {}, {}
    for number, book in enumerate(books):
        header.update(book.header)
        options.update(book.options)
        definitions.update(book.definitions)
        now = {name: one for name, one in book.parameters.items() if in_force(one[1], day)}
        parameters.update({name: (value, "") for name, (value, _) in now.items()})
        for name in (*book.dropped, *book.silent):
            del rules[name]
        for name, weight in book.softened.items():
            head, inner = rules[name]
            rules[name] = ({**head, "strength": "soft", "weight": weight}, inner)
        rules.update(book.rules)
        changed = {**book.overrides, **book.confirmed}
        owners.update(dict.fromkeys((*book.rules, *changed), f"b{number}"))
        laws.update(dict.fromkeys(book.rules, f"b{number}"))
        step = {True: "1/2", False: "2"}[book.header["step"]] if "step" in book.header else "1"
        steps.update(dict.fromkeys(book.rules, step))
        for name, (head, inner) in changed.items():
            if "cite" in inner:
                laws[name] = f"b{number}"
            before = dict(rules[name][1])
            if "cite" in inner:  # another provision: what was read elsewhere does not speak of it
                before.pop("source", None)
                before.pop("certainty", None)
            rules[name] = ({**rules[name][0], **head}, {**before, **inner})
            if "accept" in inner:
                steps[name] = step
    left = {
        name: rule for name, rule in rules.items() if in_force(rule[1].get("in force", ""), day)
    }
    flat = Book(header, left, options=options, parameters=parameters, definitions=definitions)
    return flat, steps, owners, {name: law for name, law in laws.items() if law != f"b{number}"}


@given(chains(), st.sampled_from(DAYS))
def test_a_chain_of_rulebooks_is_one_merged_by_hand(books, day):
    with TemporaryDirectory() as folder:
        for number, book in enumerate(books):
            path = Path(folder, f"b{number}.rules")
            path.write_text(book_text(book, number), encoding="utf-8")
        found = load_rulebook(path, at=day)
    flat, steps, owners, inherited = merged_by_hand(books, day)
    expected = parse_rulebook(book_text(flat, 0), at=day)
    assert [str(rule.step_s) for rule in found.rules] == [steps[rule.name] for rule in found.rules]
    assert [rule.book for rule in found.rules] == [owners[rule.name] for rule in found.rules]
    laws = [rule.inherited_from for rule in found.rules]
    assert laws == [inherited.get(rule.name, "") for rule in found.rules]
    alike = [replace(rule, book="", step_s=1, inherited_from="") for rule in found.rules]
    assert alike == [replace(rule, book="", step_s=1) for rule in expected.rules]
    assert found.traffic == expected.traffic
    assert found.semantics == expected.semantics
    assert found.priorities == expected.priorities == {("safety", "legal")}
    assert found.extends == tuple(f"b{number}" for number in reversed(range(len(books) - 1)))
    kinds = [(one.name, one.kind) for one in found.remarks]
    said = [
        ([(name, "dropped") for name in book.dropped])
        + [(name, "silent") for name in book.silent]
        + [(name, "softened") for name in book.softened]
        for book in books
    ]
    assert kinds == [one for some in said for one in some]


def test_also_unless_adds_to_what_is_inherited_and_unless_replaces_it(tmp_path):
    head = "signal p, q, r default false\n"
    base = f"rulebook base\n{head}hard rule a {{ require never p unless q when r }}\n"
    Path(tmp_path, "base.rules").write_text(base)
    made = {}
    for word, whole in (("also unless", "unless q unless r"), ("unless", "unless r")):
        over = f"rulebook over\nextends base\noverride rule a {{ {word} r }}\n"
        Path(tmp_path, "over.rules").write_text(over)
        by_hand = f"rulebook over\n{head}hard rule a {{ require never p {whole} when r }}\n"
        rule = load_rulebook(Path(tmp_path, "over.rules")).rules[0]
        made[word] = rule.formula
        assert made[word] == parse_rulebook(by_hand).rules[0].formula
    assert made["also unless"] != made["unless"]


@pytest.mark.parametrize(
    ("change", "inherited"),
    [
        ('drop rule unknown because "so"', "`base_rule`"),
        ("set unknown = 3 m", "`base_room`"),
        ("redefine unknown = wet", "`base_word`"),
    ],
)
def test_what_there_is_to_change_is_what_is_inherited(change, inherited, tmp_path):
    """A rulebook's own rules, parameters and definitions are not named."""
    for name, extends in (("base", "signal wet"), ("own", "extends base")):
        (tmp_path / f"{name}.rules").write_text(
            f"rulebook {name} {extends} hard rule {name}_rule {{ require never wet }}\n"
            f"param {name}_room = 1 m\ndefine {name}_word = wet\n"
        )
    path = tmp_path / "own.rules"
    path.write_text(path.read_text() + change)
    with pytest.raises(RulecError) as problem:
        load_rulebook(path)
    (found,) = [one for one in problem.value.diagnostics if one.code == "R0212"]
    assert found.help == f"`base` has {inherited}"


@pytest.mark.parametrize(
    ("name", "way_out"),
    [
        ("queue_weavin", "did you mean `queue_weaving`?"),
        ("bus_leaving", "`base` has `queue_weaving`, `red_light`"),
        ("speed_limt", "`base` has `queue_weaving`, `red_light`"),
    ],
)
def test_a_rule_of_another_name_is_no_slip(name, way_out, tmp_path):
    rules = "\n".join(
        f"hard rule {rule} {{ require never wet }}" for rule in ("queue_weaving", "red_light")
    )
    (tmp_path / "base.rules").write_text(f"rulebook base signal wet\n{rules}\n")
    path = tmp_path / "own.rules"
    path.write_text(f'rulebook own extends base\ndrop rule {name} because "why"\n')
    with pytest.raises(RulecError) as problem:
        load_rulebook(path)
    (found,) = problem.value.diagnostics
    assert found.help == way_out


@pytest.mark.parametrize(
    ("change", "now", "was"),
    [
        ("override rule r (v: car, w: vehicle)", "`v: car`", "`v: vehicle`"),
        ("override rule r (w: any, v: vehicle)", "`w: any`", "`w: vehicle`"),
        ("override rule r (v: car, w: car)", "`v: car`, `w: car`", "`v: vehicle`, `w: vehicle`"),
    ],
)
def test_an_override_about_objects_of_another_type_is_told_both(change, now, was, tmp_path):
    """To cite an article is not to exempt trucks: a narrower or wider type is told apart."""
    (tmp_path / "base.rules").write_text(
        "rulebook base\ntype any type vehicle: any type car: vehicle\n"
        "signal near(o: any), far(o: any) default false\n"
        "hard rule r (v: vehicle, w: vehicle) { require never (near(v) and far(w)) }\n"
    )

    def warnings(text):
        data = f"rulebook own\nextends base\n{text}\n".encode()
        found = diagnose("own.rules", data, tmp_path / "own.rules").findings
        return [one for one in found if one.code == "R0262"]

    (found,) = warnings(change + ' { cite "s. 1" }')
    assert found.severity == "warning"
    assert found.message == f"`r` is about {now} here, and was about {was}"
    assert f"leave the variables out to keep {was}" in found.help
    assert not warnings('override rule r { cite "s. 1" }')
    assert not warnings('override rule r (v: vehicle, w: vehicle) { cite "s. 1" }')
    assert not warnings('override rule r (v: car, w: car) { says "Anew." }')
    assert not warnings("override rule r (v: car, w: car) { require never near(v) }")


@pytest.mark.parametrize(
    ("line", "message", "way_out"),
    [
        (
            "override rule x { require never p }",
            "there is no rule `x` to override: `base` is silent on it",
            "write a rule of this rulebook's own: `hard rule x`",
        ),
        (
            'confirm rule y { cite "s. 1" }',
            "there is no rule `y` to confirm: `base` dropped it",
            "write a rule of this rulebook's own: `hard rule y`",
        ),
        (
            'drop rule y because "not here"',
            "there is no rule `y` to drop: `base` dropped it",
            "leave the line out: it is so already",
        ),
    ],
)
def test_a_change_to_what_a_base_has_left_out(tmp_path, line, message, way_out):
    (tmp_path / "first.rules").write_text(
        "rulebook first\nsignal p default false\nhard rule y { require never p }\n"
    )
    (tmp_path / "base.rules").write_text(
        'rulebook base\nextends first\nsilent on x because "no law"\ndrop rule y because "old"\n'
    )
    path = tmp_path / "own.rules"
    path.write_text(f"rulebook own\nextends base\n{line}\n")
    with pytest.raises(RulecError) as problem:
        load_rulebook(path)
    (found,) = problem.value.diagnostics
    assert (found.code, found.message, found.help) == ("R0212", message, way_out)
    (where,) = found.labels
    assert Path(where.place.file).name == "base.rules"
