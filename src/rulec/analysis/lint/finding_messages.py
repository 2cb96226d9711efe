"""Messages about what the automata of rules tell of a rulebook."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.code import Code
from rulec.rulebook.rulebook_model import Rule
from rulec.witnesses.undecided import UndecidedError

CANNOT_BE_VIOLATED = Code(
    "R0801",
    title="nothing can violate a rule",
    why="Whatever happens, the rule is kept: it forbids nothing. An enumeration has one value at a "
    "time, a number is on one side of a limit, and facts hold; all that is taken into account. So "
    "are `true`, `false` and options as they stand: a rule may be one that an option switches on.",
    bad="rulebook example\nlight is one of red, green\n"
    "hard rule r { require always (red or green) }\n",
    good="rulebook example\nlight is one of red, green\nhard rule r { require always green }\n",
    kind="analyzed",
)

CANNOT_BE_KEPT = Code(
    "R0802",
    title="nothing can keep a rule",
    why="Whatever happens, the rule is violated, as soon as there are objects that it speaks of.",
    bad="rulebook example\nlight is one of red, green\n"
    "hard rule r { require eventually (red and green) }\n",
    good="rulebook example\nlight is one of red, green\nhard rule r { require eventually green }\n",
    kind="analyzed",
)

ADDS_NOTHING = Code(
    "R0803",
    title="a rule adds nothing to others",
    why="All that the rule forbids is forbidden by another one, or by a few others together. A "
    "hard rule adds something to soft ones. Of rules that forbid the same the first counts.",
    bad="rulebook example\nsignal wet, fog\nhard rule dry { require never wet }\n"
    "hard rule clear { require never (wet and fog) }\n",
    good="rulebook example\nsignal wet, fog\nhard rule dry { require never wet }\n"
    "hard rule clear { require never fog }\n",
    kind="analyzed",
)

CONFLICTING_RULES = Code(
    "R0804",
    title="hard rules cannot all be kept",
    why="After a trace that violates none of the rules, or right from the start, whatever comes "
    "violates one of them, though each of them alone could be kept.",
    bad="rulebook example\nsignal wet, slow\n"
    "hard rule caution { require always (wet implies next slow) }\n"
    "hard rule flow { require never (wet and next slow) }\n",
    good="rulebook example\nsignal wet, slow\n"
    "hard rule caution { require always (wet implies next slow) }\n"
    "hard rule flow { require never (not wet and next slow) }\n",
    kind="analyzed",
)

NEVER_TRIGGERED = Code(
    "R0805",
    title="what a rule waits for never happens",
    why="The left side of an `implies` that always holds, the first phase of a sequence that is "
    "forbidden, a condition (`when`) or an exception (`unless`) that no state can satisfy has "
    "no effect.",
    bad="rulebook example\nquantity speed in km/h\nsignal wet\n"
    "hard rule r {\n  require always (speed < 30 km/h and speed > 50 km/h implies wet)\n}\n",
    good="rulebook example\nquantity speed in km/h\nsignal wet\n"
    "hard rule r {\n  require always (speed > 30 km/h and speed < 50 km/h implies wet)\n}\n",
    kind="analyzed",
)

WEAKER_THAN_BASE = Code(
    "R0806",
    title="a rule is weaker than in the rulebook that is extended",
    why="The rulebook that this one extends, a treaty for instance, forbids something that this "
    "one allows; or a hard rule has become soft. The trace shows what. A rule that is "
    "dropped with a reason is not meant.",
    bad="rulebook example\nextends esterle2019\n"
    "override rule R3 (p: pedestrian) { unless CONGESTED throughout }\n",
    good="rulebook example\nextends esterle2019\n"
    "override rule R3 (p: pedestrian) { require never f(p) }\n",
    kind="analyzed",
)

CONTRADICTING_RULES = Code(
    "R0808",
    title="two hard rules cannot both be kept where one of them asks for anything",
    why="Whatever keeps both rules never comes to what one of them is about: the left side of its "
    "`implies`, the first phase of the sequence that it forbids, or its condition (`when`). With "
    "either rule alone that can be. Who gets there all the same violates one of them. It is as if "
    "both together forbade it, which may be meant, but is mostly a slip, such as `<=` for `>=`.",
    bad="rulebook example\nsignal wet\nquantity speed in km/h\n"
    "hard rule slow { require always (wet implies speed <= 50 km/h) }\n"
    "hard rule fast { require always (wet implies speed >= 60 km/h) }\n",
    good="rulebook example\nsignal wet\nquantity speed in km/h\n"
    "hard rule slow { require always (wet implies speed <= 50 km/h) }\n"
    "hard rule fast { require always (not wet implies speed >= 60 km/h) }\n",
    kind="analyzed",
)

_NESTED = (
    "rulebook example\ntype car\nsignal near(c: car, d: car) default false\n"
    "hard rule r {{ require never (some c: car ({inner})) }}\n"
)
NOT_DECIDED = Code(
    "R0807",
    title="a question about a rule was not decided",
    why="Automata that are walked together can become too many states to look at, and counts "
    "inside counts are not looked at. The question is left open: the answer is not no.",
    bad=_NESTED.format(inner="some d: car (near(c, d))"),
    good=_NESTED.format(inner="near(c, c)"),
    kind="analyzed",
)


def undecided_diagnostic(rule: Rule, question: str, problem: UndecidedError) -> Diagnostic:
    """The warning (R0807) that a question about a rule was left open."""
    return NOT_DECIDED.at(
        rule.span,
        f"not decided of rule `{rule.name}` whether {question}: {problem}",
        help="say less in one rule; rules beside each other are looked at one by one",
        severity="warning",
    )
