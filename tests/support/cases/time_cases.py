"""What rules say of the future, of the past and of how a trace ends."""

from support.cases.case import BOTH, NEITHER, SIGNALS, P, Q, case

LIVE = f"""rulebook live
{SIGNALS}
hard rule answered {{ require always (p implies eventually q) }}
hard rule again    {{ require always eventually q }}
soft rule settles  {{ require eventually always p }}
"""


INSIDE = """
hard rule within    { require eventually (p and next not p) }
hard rule back      { require eventually previously previously p }
hard rule ever      { require once always p }
hard rule window    { require always (q implies once[2 steps .. 3 steps] p) }
hard rule mixed     { require always eventually always[<= 3 steps] p }
hard rule unsettled { require next always once[1 steps .. 3 steps] next p }
"""
ASKED, SAID = [[f"{name}{n}" for n in range(4)] for name in "ab"]
ANSWERED = " and ".join(
    f"({asked} implies eventually {said})" for asked, said in zip(ASKED, SAID, strict=True)
)
NEXT = """
hard rule at_once { require always (p implies next q) }
hard rule if_ever { require always (p implies weak next q) }
"""


PAST = """
hard rule first   { require not previously p }
hard rule goes_on { require next previously p }
hard rule held    { require always (q implies p since q) }
hard rule since_q { require always (p implies once[1 steps .. 2 steps] q) }
hard rule began   { require always (p implies weak previously p) }
"""


def places(**place):
    return {"place": place}


CASES_OF_TIME = {
    "liveness": case(
        LIVE,
        ([P], ("answered", "again")),
        ([P, Q], ("settles",)),
        ([P, Q, P], ("answered", "again")),
        ([P, Q, BOTH], ()),
        ([Q, NEITHER], ("again", "settles")),
    ),
    "liveness where a trace ends": case(
        LIVE.replace("live\n", "live\nsemantics finite\n", 1),
        ([P], ("answered", "again")),
        ([P, Q], ("settles",)),
        ([Q, NEITHER, BOTH], ()),
    ),
    "next, the last state going on": case(
        f"rulebook next\n{SIGNALS}{NEXT}",
        ([P], ("at_once", "if_ever")),
        ([BOTH], ()),
        ([P, Q], ()),
        ([NEITHER, P, P, Q], ("at_once @ 2", "if_ever @ 2")),
    ),
    "next, where a trace ends": case(
        f"rulebook next\nsemantics finite\n{SIGNALS}{NEXT}",
        ([P], ("at_once",)),
        ([BOTH], ("at_once",)),
        ([P, Q], ()),
        ([NEITHER, P, P, Q], ("at_once @ 2", "if_ever @ 2")),
    ),
    "the past inside of the future": case(
        f"rulebook inside\n{SIGNALS}{INSIDE}",
        ([P], ("within",)),
        ([P, NEITHER], ("ever @ 1", "mixed", "unsettled @ 1")),
        ([NEITHER, P], ("within", "ever @ 0")),
        ([NEITHER, P, NEITHER], ("ever @ 0", "mixed", "unsettled")),
        # q goes on; one step later p is four steps ago.
        ([P, NEITHER, NEITHER, Q], ("ever @ 1", "window", "mixed", "unsettled @ 1")),
        ([P, NEITHER, NEITHER, NEITHER, Q], ("ever @ 1", "window @ 4", "mixed", "unsettled @ 1")),
    ),
    "a trace that may end but not go on": case(
        f"rulebook ends\nsemantics finite\n{SIGNALS}"
        "hard rule only { require weak next false }\n"
        "hard rule last { require always (p implies weak next false) }",
        ([P], ()),
        ([NEITHER, P], ("only @ 1",)),
        ([P, NEITHER, NEITHER], ("only @ 1", "last @ 1")),
    ),
    "the past, the last state going on": case(
        f"rulebook past\n{SIGNALS}{PAST}",
        # The second instant of [P] is p, too, and nothing before it was q.
        ([P], ("since_q @ 0",)),
        ([NEITHER], ("goes_on @ 0",)),
        # It goes on with p; one step later q is too long ago.
        ([Q, P, P], ("goes_on @ 0", "began @ 1", "since_q")),
        # Three steps behind q there is no q within two steps.
        ([Q, NEITHER, NEITHER, P], ("goes_on @ 0", "since_q @ 3", "began @ 3")),
        ([Q, BOTH], ("goes_on @ 0", "began @ 1")),
    ),
    "the past, the last state of the only trace going on": case(
        f"rulebook past\n{SIGNALS}{PAST}",
        ([Q, P, P], ("goes_on @ 0", "began @ 1", "since_q")),
    ),
    "the past, where a trace ends": case(
        f"rulebook past\nsemantics finite\n{SIGNALS}{PAST}",
        ([P], ("goes_on", "since_q @ 0")),
        ([NEITHER], ("goes_on @ 0",)),
        ([Q, P, P], ("goes_on @ 0", "began @ 1")),
    ),
    "lost before it begins, and kept whatever comes": case(
        f"rulebook a\n{SIGNALS}"
        "hard rule lost { require p and not p }\nhard rule kept { require q or not q }",
        ([P, Q], ("lost @ 0",)),
    ),
    "phases, and the until of the paper": case(
        "rulebook phases\ntype thing\nplace(v: thing) is one of behind, right, left, front\n"
        "hard rule phases (v: thing) { require never (behind(v) then right(v) then front(v)) }\n"
        "hard rule printed (v: thing) "
        "{ require G !(behind(v) & X(behind(v) U right(v) U front(v))) }",
        *(
            (({"v": "thing"}, [places(v=one) for one in word.split()]), said)
            for word, said in [
                ("behind right front", ("phases v @ 2", "printed v @ 2")),
                ("behind behind right right", ()),
                ("behind front", ("printed v @ 1",)),
                ("behind left front", ()),
                ("right front behind right left front", ()),
            ]
        ),
    ),
    "bounds in steps": case(
        f"rulebook bounds\n{SIGNALS}"
        "hard rule soon  { require always (p implies eventually[<= 2 steps] q) }\n"
        "hard rule later { require always (p implies next[2 steps] q) }\n"
        "hard rule while { require p implies p until[2 steps .. 3 steps] q }\n"
        "soft rule at_ease { require p weak until[2 steps .. 3 steps] q }\n"
        "soft rule insisting { require q strong release[2 steps .. 3 steps] p }\n",
        ([P, P, Q], ("insisting @ 2",)),
        ([P, NEITHER, Q], ("while @ 1", "at_ease @ 1", "insisting @ 2")),
        (
            [P, NEITHER, NEITHER, Q],
            ("soon @ 2", "later @ 2", "while @ 1", "at_ease @ 1", "insisting @ 2"),
        ),
        ([P, P], ("soon", "later", "while", "insisting")),
        # Within the range there is always p, but not on the way there.
        ([P, NEITHER, P], ("soon @ 2", "later @ 2", "while @ 1", "at_ease @ 1", "insisting")),
        # q goes on, so it is there two and three steps later, but p is not until then.
        ([P, Q], ("while @ 1", "at_ease @ 1")),
        ([BOTH], ()),
    ),
    "more pending than a byte can tell apart": case(
        f"rulebook answers\nsignal {', '.join(ASKED)}, {', '.join(SAID)} default false\n"
        f"hard rule answered {{ require always ({ANSWERED}) }}",
        ([dict.fromkeys(ASKED, True), dict.fromkeys(SAID, True)], ()),
        ([dict.fromkeys(ASKED, True), dict.fromkeys(SAID[1:], True)], ("answered",)),
        ([{"a1": True}, {"a3": True}, {"b3": True}, {"b1": True}, NEITHER], ()),
        ([{"a1": True, "a2": True}, {"b2": True, "a0": True}, {"b0": True}], ("answered",)),
        *(([{one: True}], ("answered",)) for one in ASKED),
    ),
    "a thousand states and more": case(
        f"rulebook long\n{SIGNALS}"
        "hard rule not_both { require never (p and q) }\n"
        "hard rule in_time { require always (p implies next q) }\n"
        "hard rule comes { require eventually q }",
        ([NEITHER] * 1500, ("comes",)),
        ([*[NEITHER] * 1200, P, Q, *[NEITHER] * 400], ()),
        ([*[P, Q] * 550, BOTH, *[Q] * 10], ("not_both @ 1100",)),
        ([*[P, Q] * 550, P, NEITHER, BOTH], ("in_time @ 1101", "not_both @ 1102")),
    ),
    "bounds in seconds": case(
        f"rulebook bounds\nstep 0.5 s\n{SIGNALS}"
        "hard rule soon { require always (p implies eventually[<= 1 s] q) }",
        ([P, NEITHER, Q], ()),
        ([P, NEITHER, NEITHER, Q], ("soon @ 2",)),
        step_s=0.5,
    ),
    "bounds in seconds of another step": case(
        f"rulebook bounds\nstep 0.5 s\n{SIGNALS}"
        "hard rule soon { require always (p implies eventually[<= 1 s] q) }",
        ([P, NEITHER, Q], "R0507"),
        ([Q], "R0507"),
    ),
    "exceptions": case(
        f"rulebook exceptions\nsignal queue, sign default false\n{SIGNALS}"
        "hard rule all_of_it { require never (p then q then p) unless queue throughout }\n"
        "hard rule part { require never (p then q then p) unless queue at some point }\n"
        "hard rule at_first { require never (p then q then p) unless queue at start }\n"
        "hard rule from_first { require never (p then q then p) unless sign initially }\n",
        ([P, Q, P], ("all_of_it @ 2", "part @ 2", "at_first @ 2", "from_first @ 2")),
        ([P, {**Q, "queue": True}, P], ("from_first @ 2",)),
        ([P, {**Q, "queue": True}, Q, P], ("all_of_it @ 3", "from_first @ 3")),
        ([P, Q, {**Q, "queue": True}, P], ("all_of_it @ 3", "at_first @ 3", "from_first @ 3")),
        ([{**P, "sign": True}, Q, P], ("all_of_it @ 2", "part @ 2", "at_first @ 2")),
        (
            [P, {**Q, "sign": True}, P],
            ("all_of_it @ 2", "part @ 2", "at_first @ 2", "from_first @ 2"),
        ),
    ),
    "no states": case(LIVE, ([], "R0506"), ([P, Q], ("settles",))),
}
