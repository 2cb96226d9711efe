"""Names that nothing has, and the words of a vocabulary that mean what they say."""

import re

import pytest

from rulec import Session
from rulec.rulebook.loader import diagnose, load_vocabulary
from rulec.rulebook.names.word_meanings import DescribedWord, offer, suggestion
from rulec.vocabulary import Enumeration, Quantity

WORDS = (
    DescribedWord("crossing_zone", "ego [is|is not] on or at a pedestrian crossing"),
    DescribedWord("junction_zone", "ego [is|is not] in or at a junction"),
    DescribedWord("motorway", "the road [is|is not] a motorway", ("eine Autobahn",)),
    DescribedWord("raining", "rain [falls|does not fall]"),
    DescribedWord("limit", "the signposted speed limit"),
    DescribedWord("speed", "ego's speed"),
    DescribedWord("near_indicator", "ego [indicates|does not indicate] to the near side"),
    DescribedWord("far_indicator", "ego [indicates|does not indicate] to the far side"),
    DescribedWord("give_way_sign", "a give-way sign [is|is not] for ego"),
    DescribedWord("overtaking", "ego [overtakes|does not overtake]"),
)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("crosswalk_ahead", ["crossing_zone"]),
        ("onZebrastreifen", ["crossing_zone"]),
        ("at_intersection", ["junction_zone"]),
        ("freeway", ["motorway"]),
        ("is_snowing", ["raining"]),
        ("speeding", ["limit"]),
        ("velocity", ["speed"]),
        ("yield_sign", ["give_way_sign"]),
        ("passes", ["overtaking"]),
        ("blinker", ["near_indicator", "far_indicator"]),
        ("motorvej", ["motorway"]),
        ("Fußgängerüberweg", ["crossing_zone"]),
        ("fodgængerfelt", ["crossing_zone"]),
        ("väjningsplikt", ["give_way_sign"]),
        ("制限速度", ["limit"]),
        ("driver_drunk", []),
        ("sign_of_zodiac", []),
        ("speed_camera_flash_lamp", []),
        ("in_the", []),
        ("", []),
    ],
)
def test_words_by_what_they_mean(name, words):
    way_out = offer(name, WORDS)
    assert re.findall(r"`(\w+)`", str(way_out)) == words
    assert words == (list(way_out.offers) if words else [])


def test_a_word_is_offered_with_its_phrase():
    assert str(offer("crosswalk", WORDS)) == (
        "did you mean `crossing_zone` (ego is on or at a pedestrian crossing)?"
    )
    assert offer("crosswalk", ()) == ""


@pytest.mark.parametrize(
    ("formula", "way_out"),
    [
        ("autobahn", "did you mean `motorway` (the road is a motorway)?"),
        ("speed > 50 km / h", "a unit is one word: write `km/h`"),
        ("speed > 50 / h", "declare it, such as `signal h`"),
        ("motorwai", "did you mean `motorway`?"),
        ("is_speeding", "words that may mean it: `limit` (the signposted speed limit), `minimum_"),
        ("driver_drunk", "declare it, such as `signal driver_drunk`"),
    ],
)
def test_check_offers_them(formula, way_out):
    text = f"rulebook a\nuse road\nhard rule r {{ require never {formula} }}\n"
    (mistake,) = diagnose("a.rules", text.encode()).findings
    assert mistake.help.startswith(way_out)


@pytest.mark.parametrize(
    ("name", "known"),
    [
        *(("autobahn", "motorway"), ("freeway", "motorway"), ("abstand(v) < 5 m", "gap")),
        *(
            ("kreisverkehr_closed", "roundabout_closed"),
            ("lowest_geschwindigkeit > 3 m/s", "lowest_speed"),
        ),
    ],
)
def test_check_offers_words_of_the_rulebook_itself(name, known):
    text = (
        "rulebook a\ntype vehicle\nsignal motorway, roundabout default false\n"
        "quantity gap(v: vehicle) in m default 100\n"
        "define roundabout_closed = roundabout\nparam lowest_speed = 30 m/s\n"
        f"hard rule r (v: vehicle) {{ require never (roundabout and {name}) }}\n"
    )
    (mistake,) = (
        finding
        for finding in diagnose("a.rules", text.encode()).findings
        if finding.code == "R0202"
    )
    assert mistake.help == f"did you mean `{known}`?"


@pytest.mark.parametrize(
    ("said", "known"),
    [("lorry", "truck"), ("sporvogn", "tram"), ("gående", "pedestrian"), ("peatón", "pedestrian")],
)
def test_check_offers_types(said, known):
    text = f"rulebook a\nuse road\nhard rule r (o: {said}) {{ require never beside(o) }}\n"
    (mistake,) = diagnose("a.rules", text.encode()).findings
    assert mistake.help == f"did you mean `{known}`?"


@pytest.mark.parametrize(
    ("name", "word"),
    [
        *(("nærlys", "dipped_beam"), ("fjernlys", "main_beam"), ("kjørelys", "daytime_lamps")),
        *(("tåkelys", "front_fog_lamps"), ("kollektivfelt", "bus_lane"), ("gatetun", "home_zone")),
        *(("gågate", "pedestrian_zone"), ("gangfelt", "crossing"), ("gangfelt", "zebra")),
        *(("fart", "speed"), ("kryss", "junction"), ("rødt", "red_light")),
        *(("opholdsgade", "home_zone"), ("busbane", "bus_lane"), ("tågeslygte", "rear_fog_lamps")),
        *(("nopeus", "speed"), ("suojatie", "crossing"), ("väistää", "give_way_sign")),
        *(("rychlost", "speed"), ("přechod", "crossing"), ("křižovatka", "junction")),
        *(("velocidade", "speed"), ("passadeira", "crossing"), ("semáforo", "red_light")),
        *(("red", "red_light"), ("red", "red_cross")),
    ],
)
def test_words_in_the_languages_of_neighbours(name, word):
    vocabulary = Session().load_rulebook("de").vocabulary
    known = [*vocabulary.declarations, *vocabulary.enumeration_of]
    assert f"`{word}`" in suggestion(name, known, 0.75)


@pytest.mark.parametrize(
    ("rule", "hint"),
    [
        ("(v: vehicle) { require always gap(v) >= 3 * speed }", "way in 3 s write `3 s * speed`"),
        ("{ require never on_crossing(p) }", "such as `(p: pedestrian)`"),
        ("(v: vehicle) { require always lane_free(v) }", "did you mean `lane_is_clear` ("),
        ("{ require always night implies once[<= 2 sekunder] wet }", "did you mean `s`?"),
        ("{ require always time_to_stop_line >= 2 Sekunden }", "did you mean `s`?"),
        ("{ require always time_to_stop_line >= 2 secondes }", "did you mean `s`?"),
        ("{ require always limit >= 2 km/t }", "did you mean `km/h`?"),
        ("{ require always limit >= 2 км/ч }", "did you mean `km/h`?"),
        ("{ require always limit >= 2 км/час }", "did you mean `km/h`?"),
        ("{ require always limit >= 2 公里/小时 }", "did you mean `km/h`?"),
        ("{ require always limit >= 2 м/сек }", "did you mean `m/s`?"),
        ("{ require always acceleration >= 2 m/sek² }", "did you mean `m/s²`?"),
        ("{ require always limit >= 50 Std }", "did you mean `h`, or `km/h` for a speed?"),
        ("(v: vehicle) { require always gap(v) >= 150 cms }", "did you mean `cm`?"),
        # The half of a unit that is known does not make one of the other half.
        ("{ require always limit >= 50 km/quux }", "units are such as `m`, `km/h`"),
        ("{ require always night exept wet }", "an exception is written `unless formula`"),
    ],
)
def test_repairs_of_slips(rule, hint):
    text = f"rulebook example\nuse road\ntraffic right\nhard rule r {rule}\n"
    found = diagnose("example.rules", text.encode()).findings
    assert [hint in finding.help for finding in found] == [True]


def test_no_offer_changes_whom_a_rule_speaks_of():
    """Each word of the roads, said of more objects than it is about: `speed(v)` is not `speed`."""
    road = load_vocabulary("road")
    words = {
        word: len(item.parameters)
        for item in road.declarations.values()
        for word in (item.values if isinstance(item, Enumeration) else (item.name,))
    }
    numbers = {item.name for item in road.declarations.values() if isinstance(item, Quantity)}
    lines = [
        "rulebook a",
        "use road",
        "define still = reversing",
        "define at(v: vehicle) = near(v)",
    ]
    for word, needed in {**words, "still": 0, "at": 1}.items():
        given = "v, w" if needed else "v"
        number = " > 0" if word in numbers else ""
        lines.append(
            f"hard rule of_{word} (v: vehicle, w: vehicle) "
            f"{{ require never ({word}({given}){number} and near(w) and near(v)) }}"
        )
    found = [
        x for x in diagnose("a.rules", "\n".join(lines).encode()).findings if x.code == "R0301"
    ]
    assert len(found) == len([word for word in words.values() if word < 2]) + 2 > 190
    assert not [mistake.help for mistake in found if mistake.offers]
    of_another = {mistake.help for mistake in found if "`speed`" in mistake.message}
    assert of_another == {
        "`speed` is about ego or the world, and no word says it of `v`; did you mean "  # noqa: ISC004
        "`speed_difference` (the speed by which ego is faster than …)?"
    }
