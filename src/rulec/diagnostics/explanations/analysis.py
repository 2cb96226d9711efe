"""R08: what the automata of rules tell about a rulebook."""

from rulec.diagnostics.explanations.explanation import Explanation

_NESTED = (
    "rulebook example\ntype car\nsignal near(c: car, d: car) default false\n"
    "hard rule r {{ require never (some c: car ({inner})) }}\n"
)

ANALYSIS = {
    "R0801": Explanation(
        "nothing can violate a rule",
        "Whatever happens, the rule is kept: it forbids nothing. An enumeration has one value at a "
        "time, a number is on one side of a limit, and facts hold; all that is taken into account.",
        "rulebook example\nlight is one of red, green\n"
        "hard rule r { require always (red or green) }\n",
        "rulebook example\nlight is one of red, green\nhard rule r { require always green }\n",
        "analyzed",
    ),
    "R0802": Explanation(
        "nothing can keep a rule",
        "Whatever happens, the rule is violated, as soon as there are objects that it speaks of.",
        "rulebook example\nlight is one of red, green\n"
        "hard rule r { require eventually (red and green) }\n",
        "rulebook example\nlight is one of red, green\nhard rule r { require eventually green }\n",
        "analyzed",
    ),
    "R0803": Explanation(
        "a rule adds nothing to others",
        "All that the rule forbids is forbidden by another one, or by a few others together. A "
        "hard rule adds something to soft ones. Of rules that forbid the same the first counts.",
        "rulebook example\nsignal wet, fog\nhard rule dry { require never wet }\n"
        "hard rule clear { require never (wet and fog) }\n",
        "rulebook example\nsignal wet, fog\nhard rule dry { require never wet }\n"
        "hard rule clear { require never fog }\n",
        "analyzed",
    ),
    "R0804": Explanation(
        "hard rules cannot all be kept",
        "After a trace that violates none of the rules, or right from the start, whatever comes "
        "violates one of them, though each of them alone could be kept.",
        "rulebook example\nsignal wet, slow\n"
        "hard rule caution { require always (wet implies next slow) }\n"
        "hard rule flow { require never (wet and next slow) }\n",
        "rulebook example\nsignal wet, slow\n"
        "hard rule caution { require always (wet implies next slow) }\n"
        "hard rule flow { require never (not wet and next slow) }\n",
        "analyzed",
    ),
    "R0805": Explanation(
        "what a rule waits for never happens",
        "The left side of an `implies` that always holds, the first phase of a sequence that is "
        "forbidden, a condition (`when`) or an exception (`unless`) that no state can satisfy has "
        "no effect.",
        "rulebook example\nquantity speed in km/h\nsignal wet\n"
        "hard rule r {\n  require always (speed < 30 km/h and speed > 50 km/h implies wet)\n}\n",
        "rulebook example\nquantity speed in km/h\nsignal wet\n"
        "hard rule r {\n  require always (speed > 30 km/h and speed < 50 km/h implies wet)\n}\n",
        "analyzed",
    ),
    "R0806": Explanation(
        "a rule is weaker than in the rulebook that is extended",
        "The rulebook that this one extends, a treaty for instance, forbids something that this "
        "one allows; or a hard rule has become soft. The trace shows what. A rule that is "
        "dropped with a reason is not meant.",
        "rulebook example\nextends esterle2019\n"
        "override rule R3 (p: pedestrian) { unless CONGESTED throughout }\n",
        "rulebook example\nextends esterle2019\n"
        "override rule R3 (p: pedestrian) { require never f(p) }\n",
        "analyzed",
    ),
    "R0807": Explanation(
        "a question about a rule was not decided",
        "Automata that are walked together can become too many states to look at, and counts "
        "inside counts are not looked at. The question is left open: the answer is not no.",
        _NESTED.format(inner="some d: car (near(c, d))"),
        _NESTED.format(inner="near(c, c)"),
        "analyzed",
    ),
}
