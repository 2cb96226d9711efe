"""What rulebooks say with numbers, defaults, levels, parameters and other rulebooks."""

from support.cases.case import NEITHER, SIGNALS, P, Q, case

CARS = {"a": "car", "b": "car"}
NUMBERS = """rulebook numbers
type car
quantity gap(v: car) in m
quantity room in m
quantity more in m
quantity speed in km/h default 50
hard rule equal  { require always not room = 0.3 m }
hard rule below  { require always room < 2 m }
hard rule sum    { require always room + more <= 0.3 m }
hard rule slow   { require always (speed <= 36 km/h or room >= 0 cm) }
hard rule closer (v: car, w: car) { require never gap(v) - gap(w) > 1 m }
"""


MANY = [f"s{n}" for n in range(9)]

VEHICLE = {"v": "vehicle"}


def at(letter):
    return {"position": {"v": letter}}


def room(metres, more=0, **others):
    return {"room": metres, "more": more, **others}


CASES_OF_RULEBOOKS = {
    "defaults": case(
        "rulebook defaults\ntype car\nsignal lit(v: car), day default true\n"
        "surface is one of dry, wet default wet\nquantity speed in km/h default 50\n"
        "hard rule dark (v: car) { require never lit(v) }\n"
        "hard rule night { require never day }\n"
        "hard rule dry { require always dry }\n"
        "hard rule slow { require always speed < 50 km/h }",
        (({"a": "car"}, [{}]), ("dark a @ 0", "night @ 0", "dry @ 0", "slow @ 0")),
        (
            ({"a": "car", "b": "car"}, [{"lit": {"a": False}, "day": False, "surface": "dry"}]),
            ("dark b @ 0", "slow @ 0"),
        ),
        # Nothing carries over from the state before.
        ([{"day": False, "surface": "dry", "speed": 49}, {"speed": 0}], ("night @ 1", "dry @ 1")),
    ),
    "numbers as they are written": case(
        NUMBERS,
        ([room(0.1, 0.2)], ()),
        ([room(0.2, 0.1, speed=36)], ()),
        ([room(0.3)], ("equal @ 0",)),
        ([room(0.30000000000000004)], ("sum @ 0",)),
        ([room(0, -1), room(0.3), room(0.29999999999999999)], ("equal @ 1",)),
        ([room(1.9999999999999998, -2)], ()),
        ([room(-1), room(2, -2)], ("slow @ 0", "below @ 1")),
        ([room(-1e300, speed=36), room(1e300, -1e300)], ("below @ 1",)),
        ((CARS, [room(0, gap={"a": 1.5, "b": 0.5})]), ()),
        ((CARS, [room(0, gap={"a": 0.5, "b": 1.6})]), ("closer b a @ 0",)),
    ),
    "more states than a byte can tell apart": case(
        "rulebook fast\nquantity speed in km/h\nquantity rank in km\n"
        "hard rule slow { require always speed <= 250 km/h }\n"
        "hard rule order { require always rank <= 299 km }",
        ([{"speed": n, "rank": 300 - n} for n in range(300)], ("slow @ 251", "order @ 0")),
        ([{"speed": n, "rank": n} for n in range(251)], ()),
        ([{"speed": 250.5 - n, "rank": n + 1} for n in range(299)], ("slow @ 0",)),
    ),
    "more at once than a byte can tell apart": case(
        f"rulebook many\nsignal {', '.join(MANY)} default false\n"
        f"hard rule together {{ require never ({' and '.join(MANY)}) }}\n"
        + "\n".join(f"soft rule of_{name} {{ require eventually {name} }}" for name in MANY),
        ([dict.fromkeys(MANY, True)], ("together @ 0",)),
        ([dict.fromkeys(MANY[:8], True)], ("of_s8",)),
        ([dict.fromkeys(MANY[1:], True), dict.fromkeys(MANY[:3], True)], ()),
    ),
    "hard and soft rules, levels and weights": case(
        f"rulebook levels\npriority high > low\n{SIGNALS}"
        "hard rule of_p in low weight 3 { require never p }\n"
        "soft rule of_q in high { require never q }\nsoft rule of_none { require p or q }",
        ([P], ("of_p @ 0",)),
        ([Q, P], ("of_q @ 0", "of_p @ 1")),
        ([NEITHER], ("of_none @ 0",)),
    ),
    "parameters and definitions": case(
        "rulebook parameters\ntype car\nquantity gap(v: car) in m\nsignal town default false\n"
        "param inside : length = 150 cm\noption strict = on\n"
        "define close(v: car) = gap(v) < (inside if town else 2 m)\n"
        "hard rule apart (v: car) { require never close(v) or not strict }",
        *(
            (({"v": "car"}, [{"gap": {"v": gap}, "town": town}]), said)
            for gap, town, said in [
                (1.5, True, ()),
                (1.4999, True, ("apart v @ 0",)),
                (1.5, False, ("apart v @ 0",)),
                (2, False, ()),
            ]
        ),
    ),
    "a rulebook upon another one": case(
        """rulebook island
extends esterle2019
override rule R1 (v: vehicle) {
  require not CONGESTED implies never (b(v) then l(v) then f(v))
}
soften rule R2 weight 2 because "the act only recommends it"
drop rule R3 because "the island has no crossings"
soft rule R4 (p: pedestrian) { require never f(p) }""",
        ((VEHICLE, [at("b"), at("l"), at("f")]), ("R1 v @ 2",)),
        ((VEHICLE, [at("b"), at("r"), at("f")]), ()),
        ((VEHICLE, [{**at("b"), "CONGESTED": True}, at("l"), at("f")]), ()),
        ((VEHICLE, [at("b"), at("l"), {**at("f"), "surface": "R_pc"}]), ("R1 v @ 2", "R2 v @ 2")),
        (({"v": "pedestrian"}, [{**at("f"), "surface": "R_pc"}]), ("R4 v @ 0",)),
    ),
}
