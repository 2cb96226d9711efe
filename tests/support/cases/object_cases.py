"""What rules say of objects that come and go, and of what is known of them."""

from support.cases.case import BOTH, P, Q, case

OBJECTS = """rulebook objects
type thing
type car is thing
place(v: thing) is one of near, far, gone default gone
signal loud(v: thing) default false
"""


CARS = {"a": "car", "b": "car"}


MIXED = {"a": "car", "t": "thing"}


def places(**place):
    return {"place": place}


def loud(*names):
    return {"loud": dict.fromkeys(names, True)}


CASES_OF_OBJECTS = {
    "no objects": case(
        f"{OBJECTS}"
        "hard rule about_all (v: car) { require loud(v) and not loud(v) }\n"
        "hard rule nobody { require always count v: car (near(v)) = 0 }\n"
        "hard rule somebody { require eventually some v: car (near(v)) }\n"
        "hard rule everybody { require always every v: car (near(v)) }",
        ([{}], ("somebody",)),
        (({"t": "thing"}, [places(t="near"), {}]), ("somebody",)),
        (({"a": "car"}, [places(a="near")]), ("about_all a @ 0", "nobody @ 0")),
        (({"a": "car"}, [{}]), ("about_all a @ 0", "somebody", "everybody @ 0")),
    ),
    "types, and the distinct objects of several variables": case(
        f"{OBJECTS}"
        "hard rule apart (v: car, w: car) { require never (near(v) and far(w)) }\n"
        "hard rule order (v: car, w: thing) { require not far(w) until near(v) }",
        ((CARS, [places(a="near", b="far")]), ("apart a b @ 0", "order b a")),
        ((CARS, [places(a="far", b="near")]), ("apart b a @ 0", "order a b")),
        ((CARS, [places(a="near"), places(b="far")]), ("order b a",)),
        ((MIXED, [places(a="near", t="far")]), ()),
        ((MIXED, [places(a="far", t="near")]), ("order a t",)),
        ((MIXED, [places(t="far"), places(a="near")]), ("order a t @ 0",)),
        (({"a": "car"}, [places(a="far")]), ()),
    ),
    "objects that come late and leave early": case(
        f"{OBJECTS}"
        "hard rule comes (v: car) { require eventually near(v) }\n"
        "hard rule was (v: car) { require always (near(v) implies historically near(v)) }\n"
        "hard rule never_both (v: car, w: car) { require never (near(v) and near(w)) }",
        # b leaves before it comes near; that somebody goes on does not help it.
        ((CARS, [{}, places(a="near"), places(a="near")], {"b": (0, 1)}), ("comes b", "was a @ 1")),
        # For b the past begins with its own first state.
        ((CARS, [{}, {}, places(b="near")], {"b": (2, 2)}), ("comes a",)),
        # They are near one after the other, and are never there together.
        ((CARS, [places(a="near"), places(b="near")], {"a": (0, 0), "b": (1, 1)}), ()),
        (
            (
                CARS,
                [places(a="near"), places(a="near"), places(a="near", b="near")],
                {"b": (1, 2)},
            ),
            ("never_both a b @ 2", "never_both b a @ 2", "was b @ 2"),
        ),
    ),
    "counts of those who are there": case(
        f"{OBJECTS}"
        "hard rule quiet { require always count o: thing (loud(o)) < 2 }\n"
        "hard rule alone (v: car) { require never some o: thing (o != v and loud(o)) }\n"
        "hard rule itself (v: car) { require always (loud(v) implies some o: car (loud(o))) }\n"
        "hard rule few { require always count o: car (near(o)) < 1.5 }",
        ((CARS, [places(a="near")]), ()),
        ((CARS, [places(a="near", b="near")]), ("few @ 0",)),
        ((CARS, [loud("a")]), ("alone b @ 0",)),
        ((CARS, [{}, loud("a", "b")]), ("quiet @ 1", "alone a @ 1", "alone b @ 1")),
        ((MIXED, [loud("t", "a")]), ("quiet @ 0", "alone a @ 0")),
        # t has left: it is not counted.
        ((MIXED, [{}, loud("a")], {"t": (0, 0)}), ()),
        ((MIXED, [loud("t"), {}], {"a": (1, 1)}), ()),
    ),
    "unknown values": case(
        "rulebook unknown\ntype car\nsignal lit(v: car), day, unread\n"
        "hard rule by_day { require eventually day }\n"
        "hard rule lights (v: car, w: car) { require always (lit(v) or lit(w)) }",
        ([{"day": True}, {}], "R0504"),
        ([{"day": False, "unread": True}], ("by_day",)),
        (({"a": "car"}, [{"day": True}]), ()),
        ((CARS, [{"day": True, "lit": {"a": True}}]), "R0504"),
        # Only where both are there does anybody ask.
        ((CARS, [{"day": True}, {"day": True, "lit": {"a": True, "b": False}}], {"b": (1, 1)}), ()),
    ),
    "what a count need not know": case(
        "rulebook unknown\ntype car\nquantity gap(v: car, w: car) in m\n"
        "hard rule alone (v: car) "
        "{ require never some w: car (w != v and gap(v, w) < 5 m) }",
        ((CARS, [{"gap": {"a": {"b": 4}, "b": {"a": 6}}}]), ("alone a @ 0",)),
        ((CARS, [{"gap": {"a": {"b": 4}}}]), "R0504"),
        ((CARS, [{"gap": {"a": {"b": 4}}}], {"b": (0, 0)}), "R0504"),
        ((CARS, [{"gap": {"a": {"b": 5}, "b": {"a": 5}}}, {}], {"b": (0, 0)}), ()),
    ),
    "facts": case(
        "rulebook facts\ntype car\nsignal loud(v: car), horn, p, q default false\n"
        "fact not (p and q)\nfact loud(v) implies horn\nfact count v: car (loud(v)) <= 1\n"
        "hard rule of_both { require eventually (p and q) }\n"
        "hard rule of_loud (v: car) { require never (loud(v) and next loud(v)) }\n",
        # No state is both, so there never was any hope.
        ([P, Q], ("of_both @ 0",)),
        ([P, BOTH], "R0508"),
        ((CARS, [loud("a", "b")]), "R0508"),
        # No rule reads the horn.
        ((CARS, [loud("a"), loud("a")]), ("of_both @ 0", "of_loud a @ 1")),
        # One after the other they are loud; each until it leaves, as if for ever.
        (
            (CARS, [loud("a"), loud("b")], {"a": (0, 0), "b": (1, 1)}),
            ("of_both @ 0", "of_loud a", "of_loud b"),
        ),
    ),
    "what a fact makes follow need not be said": case(
        "rulebook facts\ntype car\n"
        "signal parked(v: car), stopped(v: car), lit(v: car) default false\n"
        "fact parked(v) implies stopped(v)\nfact stopped(v) implies lit(v)\n"
        "hard rule dark (v: car) { require never lit(v) }\n"
        "hard rule going (v: car) { require never (parked(v) or stopped(v)) }",
        ((CARS, [{"parked": {"a": True}}]), ("dark a @ 0", "going a @ 0")),
        ((CARS, [{}, {"stopped": {"a": True, "b": False}}]), ("dark a @ 1", "going a @ 1")),
        ((CARS, [{"parked": {"a": True}, "lit": {"b": False}}]), ("dark a @ 0", "going a @ 0")),
        ((CARS, [{"parked": {"a": True}, "stopped": {"a": False}}]), "R0508"),
        ((CARS, [{"parked": {"a": False}, "stopped": {"a": False}}]), ()),
    ),
    "facts about two objects, in either order": case(
        "rulebook facts\ntype car\nsignal follows(v: car, w: car), loud(v: car) default false\n"
        "fact follows(v, w) implies loud(w)\n"
        "hard rule of_two (v: car, w: car) { require never (follows(w, v) and not loud(v)) }",
        ((CARS, [{"follows": {"a": {"b": True}}}]), "R0508"),
        ((CARS, [{"follows": {"a": {"b": True}}, **loud("b")}]), ()),
    ),
    "facts about a type say nothing of those above it": case(
        "rulebook facts\ntype car\ntype bus is car\nsignal loud(v: car) default false\n"
        "fact not loud(b)\nhard rule cars (v: car) { require always not loud(v) }\n"
        "hard rule buses (b: bus) { require always not loud(b) }".replace(
            "fact not loud(b)", "signal old(b: bus) default false\nfact not (old(b) and loud(b))"
        ).replace("always not loud(b)", "never (old(b) and loud(b) or loud(b))"),
        (({"c": "car"}, [loud("c")]), ("cars c @ 0",)),
        (({"b": "bus"}, [loud("b")]), ("cars b @ 0", "buses b @ 0")),
        (({"b": "bus"}, [{**loud("b"), "old": {"b": True}}]), "R0508"),
    ),
    "what does not fit the vocabulary": case(
        f"{OBJECTS}hard rule quiet (v: car) {{ require never loud(v) }}",
        ([{"lout": True}], "R0502"),
        ((CARS, [{}, {"loud": {"a": "yes"}}]), "R0503"),
        ((CARS, [places(a="nearer")]), "R0503"),
        ((CARS, [{"loud": {"nobody": True}}]), "R0505"),
        (({"a": "plane"}, [{}]), "R0505"),
        ((CARS, [loud("a"), {}]), ("quiet a @ 0",)),
    ),
    "three hundred objects": case(
        f"{OBJECTS}"
        "hard rule quiet (v: car) { require never loud(v) }\n"
        "soft rule comes (v: car) { require eventually near(v) }\n"
        "hard rule room { require always count v: car (near(v)) <= 100 }",
        (
            (
                {f"o{n}": "car" for n in range(300)},
                [
                    places(**{f"o{n}": "near" for n in range(100)}),
                    {
                        **places(**{f"o{n}": "near" for n in range(50, 151)}),
                        **loud(*(f"o{n}" for n in range(0, 300, 3))),
                    },
                ],
            ),
            (
                "room @ 1",
                *(f"quiet o{n} @ 1" for n in range(0, 300, 3)),
                *(f"comes o{n}" for n in range(151, 300)),
            ),
        ),
    ),
}
