"""What rules cite, looked for in a law's text, in two states of it, and among listed articles."""

import pytest

from rulec.analysis.audit.citations import references_in
from rulec.analysis.audit.law_text import law_text
from rulec.analysis.audit.provision_coverage import provisions_of, unlisted
from rulec.analysis.audit.rulebook_audit import check_cites
from rulec.diagnostics import RulecError, Source
from rulec.rulebook.loader import parse_rulebook

MARKDOWN = """\
# Road Traffic Act

## Part I

### § 4 Distance

(1) Keep a distance. Brake not without need, z. B. Birds.

### § 5 Overtaking

(1) Overtake on the left.

(2) Overtake if

1.  you can see,

2.  you are

    a)  faster by 20 km/h. That is little.

    b)  alone.

(2a) Keep 1.5 m away. Lorries keep 2 m.

### § 5a Zones

Zones are signed, see § 5 paragraph 1.

### Final words

These are not of § 5a.

### Annex 2 Signs

    *   Sign 205

    *   Give way.

*   *   4

    *   Sign 206

    *   Stop. Sign 205 may announce it.
"""

PLAIN = """\
Article 4
Distance

1. Keep a distance.

Article 5. Overtaking

I. Overtake on the left.

II. Not at
Article 4 crossings.
"""

PORTUGUESE = """\
Artigo 18.º
Distância

1 — Keep a distance.

2 — Leave room.

Artigo 18.º-A

Cycles.
"""

SWEDISH = """2 kap. Signs and signals

1 a § Signs.

3 kap. Traffic with vehicles

17 §   Keep a distance.

18 §   Leave room. See 2 kap. 1 §.
"""


@pytest.mark.parametrize(
    ("cite", "expected", "unread"),
    [
        ("§ 5(4) s. 3, 4", ["§ 5(4) s. 3", "§ 5(4) s. 4"], ()),
        ("§ 46(6), 47", ["§ 46(6)", "§ 47"], ()),
        ("§ 21760(c), (d)", ["§ 21760(c)", "§ 21760(d)"], ()),
        ("§ 3(3) no. 2c s. 2", ["§ 3(3) no. 2c s. 2"], ()),
        ("R412-12 I, II", ["R412-12 I", "R412-12 II"], ()),
        ("Rules H2, 195", ["Rules H2", "Rules 195"], ()),
        ("Annex 2, signs 295 and 296", ["Annex 2", "signs 295", "signs 296"], ()),
        ("art. 145 c. 2, 154 c. 1 b", ["art. 145 no. 2", "art. 154 no. 1b"], ()),
        ("3:31, 3:7 p. 4", ["3:31", "3:7 no. 4"], ()),
        ("reg. 4, 5 (1989)", ["reg. 4", "reg. 5"], ()),
        ("§ 4(1), case law", ["§ 4(1)"], ("case law",)),
        ("§ 7 nr. 2 bokstav a", ["§ 7 no. 2a"], ()),
        ("§ 7 NR 2", ["§ 7 no. 2"], ()),
        ("§7, stk. 2, nr. 3, litra a, 2. pkt.", ["§ 7(2) no. 3a s. 2"], ()),
        ("§ 7 stk. 2 og 3", ["§ 7(2)", "§ 7(3)"], ()),
        ("§ 7 første ledd", ["§ 7(1)"], ()),
        ("§ 7 a nr. 2", ["§ 7a no. 2"], ()),
        ("3 kap. 15 § andra stycket 2", ["3:15(2) no. 2"], ()),
        ("7 a § 2 mom.", ["§ 7a(2)"], ()),
        ("artikel 7, eerste lid, onder a", ["artikel 7(1)a"], ()),
        ("§ 5 Abs. 3 Nr. 1 Buchst. a und § 6", ["§ 5(3) no. 1a", "§ 6"], ()),
        ("§ 53 Abs 1 Z 24", ["§ 53(1) no. 24"], ()),
        ("article R. 412-6 al. 2", ["article R412-6(2)"], ()),
        ("art. 19 comma 2 lett. b) e 40", ["art. 19 no. 2b", "art. 40"], ()),
        ("artículo 7 apartado 2 letra b) y 8", ["artículo 7(2)b", "artículo 8"], ()),
        ("art. 17 ust. 1 pkt 2 lit. a", ["art. 17(1) no. 2a"], ()),
        ("§ 17 odst. 1 písm. a) a § 18", ["§ 17(1)a", "§ 18"], ()),
        ("art. 22bis para. 2", ["art. 22bis(2)"], ()),
        ("Artigo 18.º, n.º 2", ["Artigo 18 no. 2"], ()),
        ("art. 18.º n.os 1 e 2", ["art. 18 no. 1", "art. 18 no. 2"], ()),
        ("Artigo 27.º n.º 1 alínea a)", ["Artigo 27 no. 1a"], ()),
        ("Artigos 41.º e 42.º", ["Artigos 41", "Artigos 42"], ()),
        ("artigo 18.º-A", ["artigo 18-A"], ()),
        ("artículo 7º apartado 2", ["artículo 7(2)"], ()),
        ("vtrl. § 6(1)", [], ("vtrl. § 6(1)",)),
        ("Convention Art. 10(3); § 7(3a)", ["§ 7(3a)"], ("Convention Art. 10(3)",)),
    ],
)
def test_what_a_cite_names(cite, expected, unread):
    found, rest = references_in(cite)
    assert ([str(one) for one in found], rest) == (expected, unread)


@pytest.mark.parametrize(
    ("text", "cite", "expected"),
    [
        (MARKDOWN, "§ 5(1)", "Overtake on the left."),
        # An initial and its full stop end no sentence.
        (MARKDOWN, "§ 4(1) s. 2", "Brake not without need, z. B. Birds."),
        (MARKDOWN, "§ 5(2) no. 1", "you can see,"),
        (MARKDOWN, "§ 5(2) no. 2a s. 2", "That is little."),
        (MARKDOWN, "§ 5(2a) s. 2", "Lorries keep 2 m."),
        (MARKDOWN, "§ 5a", "Zones are signed, see § 5 paragraph 1."),
        (MARKDOWN, "Annex 2, sign 205", "* Sign 205 * Give way."),
        (PLAIN, "Art. 4 no. 1", "Keep a distance."),
        ("163 Overtake\n\n(a) Left.\n\n164 Lorries\n", "Rule 163(a)", "Left."),
        (PLAIN, "Art. 5 II", "Not at Article 4 crossings."),
        (PORTUGUESE, "artigo 18.º, n.º 2", "Leave room."),
        (PORTUGUESE, "artigo 18.º-A", "Cycles."),
        ("Artykuł 24\n\nOvertake.\n", "art. 24", "Overtake."),
        ("ARTÍCULO 27\n\nOvertake.\n", "art. 27", "Overtake."),
        ("Čl. 5\n\nOvertake.\n", "čl. 5", "Overtake."),
        (SWEDISH, "3 kap. 17 §", "Keep a distance."),
        (SWEDISH, "3:18 s. 2", "See 2 kap. 1 §."),
        (SWEDISH, "2 kap. 1 a §", "Signs."),
        ("5 §\n\nLeave room.\n\n7 a §\n\n1 mom. Signal.\n", "§ 5", "Leave room."),
        # `s.` begins sentences, too: these articles have only numbers.
        ("1 Roads\n\ns. 4 says more.\n\n2 Zones\n\nEnd.\n", "Art. 1", "s. 4 says more."),
    ],
)
def test_a_place_is_found(text, cite, expected):
    *_, place = references_in(cite)[0]
    assert law_text(Source("act.md", text)).find(place) == expected


@pytest.mark.parametrize(
    ("cite", "why"),
    [
        ("§ 6", "act.md has no § 6"),
        ("§ 5(3)", "act.md has § 5, but no § 5(3)"),
        ("§ 5(2a) s. 3", "act.md has § 5(2a), but no § 5(2a) s. 3"),
        ("sign 207", "act.md has no sign 207"),
    ],
)
def test_a_place_is_not_found(cite, why):
    law = law_text(Source("act.md", MARKDOWN))
    ((place,), _) = references_in(cite)
    assert (law.find(place), law.missing(place)) == (None, why)


def test_a_text_without_articles_is_refused():
    with pytest.raises(RulecError) as caught:
        law_text(Source("act.md", "Drive with care.\n"))
    assert [one.code for one in caught.value.diagnostics] == ["R0714"]


BOOK = parse_rulebook(
    'rulebook country\nlaw "Act"\nsignal p\n'
    'provisions "https://example.org" { "§ 4" "Distance"; "§ 5" "Overtaking" to do;\n'
    '"§ 5(2a)" "Room" silent because "no"; "§ 5a" "Zones" not machine-readable because "vague";\n'
    '"Annex 2" "Signs"; "Customs" "No article" }\n'
    + "".join(
        f'hard rule {name} {{ cite "{cite}" require p }}\n'
        for name, cite in {
            "left": "§ 5(1)",
            "room": "§ 5(2a) s. 1",
            "room_of_lorries": "§ 5(2a) s. 2, Customs",
            "stop": "Annex 2, sign 206",
            "gone": "§ 4(2)",
            "other": "§ 7",
        }.items()
    )
)


def test_exactly_the_rules_that_rest_on_what_changed_are_named():
    before = law_text(Source("old.md", MARKDOWN))
    now = MARKDOWN.replace("Keep 1.5 m away.", "Keep  1.7 m\naway.").replace("Give way.", "Yield.")
    checks = check_cites(BOOK, before, law_text(Source("new.md", now)))
    assert [(one.rule, one.place, one.result) for one in checks] == [
        ("left", "§ 5(1)", "found"),
        ("room", "§ 5(2a) s. 1", "law-changed"),
        ("room_of_lorries", "§ 5(2a) s. 2", "found"),
        ("room_of_lorries", "Customs", "unread"),
        ("stop", "sign 206", "found"),
        ("gone", "§ 4(2)", "not-found"),
        ("other", "§ 7", "not-found"),
    ]
    assert checks[1].note == "was “1.5 m away.”, is “1.7 m away.”"


def test_articles_are_covered_by_the_rules_that_cite_them_or_a_part_of_them():
    listed = {one.number: (one.state, one.rules, one.because) for one in provisions_of(BOOK)}
    assert listed == {
        "§ 4": ("covered", ("gone",), ""),
        "§ 5": ("covered", ("left",), ""),
        # The closest entry counts.
        "§ 5(2a)": ("covered", ("room", "room_of_lorries"), ""),
        "§ 5a": ("not machine-readable", (), "vague"),
        "Annex 2": ("covered", ("stop",), ""),
        "Customs": ("covered", ("room_of_lorries",), ""),
    }
    assert list(unlisted(BOOK)) == [("other", "§ 7")]


SECOND_LAW = parse_rulebook(
    'rulebook country\nlaw "Act"\nsignal p\n'
    'provisions "https://example.org" { "§ 7" "Way"; "VRV 4" "Speed" to do }\n'
    'hard rule first { cite "§ 7 nr. 2" require p }\n'
    'hard rule both { cite "vtrl. § 6(1), §7, a custom" require p }\n'
    'hard rule longer { cite "VRV 41(2)" require p }\n'
)


def test_a_cite_whose_article_is_not_found_in_the_list_is_said_to_be_so():
    assert list(unlisted(SECOND_LAW)) == [("both", "vtrl. § 6(1)"), ("longer", "VRV 41(2)")]
    states = {one.number: (one.state, one.rules) for one in provisions_of(SECOND_LAW)}
    assert states == {"§ 7": ("covered", ("first", "both")), "VRV 4": ("to do", ())}


def test_a_cite_of_another_law_is_said_to_be_taken_for_one():
    checks = check_cites(SECOND_LAW, law_text(Source("act.md", "### § 7 Way\n\n2. Give way.\n")))
    notes = {one.place: one.note for one in checks if one.rule == "both"}
    assert notes == {
        "§ 7": "",
        "vtrl. § 6(1)": "`vtrl.` before the article is taken for another law",
        "a custom": "it names no article to look up",
    }


MANY = 200_000
"""So much of anything that work which grows with its square would never end."""


@pytest.mark.parametrize(
    ("text", "cite", "expected"),
    [
        ("§ 1 A\n\n" * MANY, "§ 1", ""),
        ("### Annex 2\n\nSign 1 a\n" + "\n" * MANY + "Sign 2 b\n", "sign 2", "Sign 2 b"),
        ("### Annex 2\n\nSign 1 a" + " |" * MANY + "y\n", "sign 1", f"Sign 1 a{' |' * MANY}y"),
        ("### Annex 2\n\nSign 1 a |\n| 12 |\n| Sign 2\n", "sign 1", "Sign 1 a"),
        ("### § 5 A\n\n(4) Begin. " + "Nr. A " * MANY, "§ 5(4) s. 1", "Begin."),
        ("1" * MANY + "\n\n7 A\n\nBegin.\n", "Art. 7", "Begin."),
        ("1" * MANY + "\n\n7 §\n\nBegin.\n", "§ 7", "Begin."),
    ],
)
def test_long_texts_are_read_once(text, cite, expected):
    *_, place = references_in(cite)[0]
    assert law_text(Source("act.md", text)).find(place) == expected


@pytest.mark.parametrize("cite", ["§ 1-{}", "§ 5(1) s. {}", "§ 5(2) no. 1, {}", "§ {}", "sign {}"])
def test_numbers_too_long_to_be_any_are_not_found(cite):
    (*_, place), unread = references_in(cite.format("9" * 5_000))
    assert unread == ()
    assert place.several() == (place,)
    assert law_text(Source("act.md", MARKDOWN)).find(place) is None
