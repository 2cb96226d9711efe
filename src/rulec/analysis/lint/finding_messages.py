"""Messages about findings from the automata of rules."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.code import Code
from rulec.rulebook.rulebook_model import Rule
from rulec.witnesses.undecided import UndecidedError

CANNOT_BE_VIOLATED = Code(
    "R0801",
    title="nothing can violate a rule",
    why="Whatever happens, the rule is kept: it forbids nothing. This takes into account that an "
    "enumeration has one value at a time, that a number is on one side of a limit, and that facts "
    "hold; and also `true`, `false` and options as they are set, so the rule may be one that an "
    "option switches on.",
    bad="rulebook example\nlight is one of red, green\n"
    "hard rule r { require always ⟪(red or green)|green⟫ }\n",
    kind="analyzed",
)

CANNOT_BE_KEPT = Code(
    "R0802",
    title="nothing can satisfy a rule",
    why="Whatever happens, the rule is violated as soon as there are objects that it is about.",
    bad="rulebook example\nlight is one of red, green\n"
    "hard rule r { require eventually ⟪(red and green)|green⟫ }\n",
    kind="analyzed",
)

ADDS_NOTHING = Code(
    "R0803",
    title="a rule is implied by others",
    why="Everything that the rule forbids is forbidden by another rule, or by a few others "
    "together. A hard rule is not implied by soft ones. Of equivalent rules, the first one counts.",
    bad="rulebook example\nsignal wet, fog\nhard rule dry { require never wet }\n"
    "hard rule clear { require never ⟪(wet and fog)|fog⟫ }\n",
    kind="analyzed",
)

CONFLICTING_RULES = Code(
    "R0804",
    title="hard rules cannot all be satisfied",
    why="After a trace that violates none of the rules, or from the start, every continuation "
    "violates one of them, although each of them alone could be satisfied. If counts tell subtypes "
    "apart, this may be so only for objects of exactly the types that are named.",
    bad="rulebook example\nsignal wet, slow\n"
    "hard rule caution { require always (wet implies next slow) }\n"
    "hard rule flow { require never (⟪|not ⟫wet and next slow) }\n",
    kind="analyzed",
)

NEVER_TRIGGERED = Code(
    "R0805",
    title="a rule's trigger never occurs",
    why="The left side of an `implies` that always holds, the first phase of a forbidden "
    "sequence, a condition (`when`) or an exception (`unless`) that can never hold has no effect.",
    bad="rulebook example\nquantity speed in km/h\nsignal wet\nhard rule r {\n"
    "  require always (speed ⟪<|>⟫ 30 km/h and speed ⟪>|<⟫ 50 km/h implies wet)\n}\n",
    kind="analyzed",
)

WEAKER_THAN_BASE = Code(
    "R0806",
    title="a rule is weaker than in the extended rulebook",
    why="The rulebook that this one extends, for instance a treaty, forbids something that this "
    "one allows, or a hard rule has become soft. The trace shows what. Rules that are dropped "
    "or softened with a reason are not reported.",
    bad="rulebook example\nextends esterle2019\n"
    "override rule R3 (p: pedestrian) { ⟪unless CONGESTED throughout|require never f(p)⟫ }\n",
    kind="analyzed",
)

CONTRADICTING_RULES = Code(
    "R0808",
    title="two hard rules cannot both be satisfied once one of them is triggered",
    why="No trace that satisfies both rules ever triggers one of them: the left side of its "
    "`implies`, the first phase of the sequence that it forbids, or its condition (`when`) never "
    "occurs. With either rule alone it can. A vehicle that gets there nevertheless violates one "
    "of the rules. In effect both together forbid it, which may be intended, but is usually a "
    "mistake, such as `<=` for `>=`.",
    bad="rulebook example\nsignal wet\nquantity speed in km/h\n"
    "hard rule slow { require always (wet implies speed <= 50 km/h) }\n"
    "hard rule fast { require always (⟪|not ⟫wet implies speed >= 60 km/h) }\n",
    kind="analyzed",
)

_NESTED = (
    "rulebook example\ntype car\nsignal near(c: car, d: car) default false\n"
    "hard rule r {{ require never (some c: car ({inner})) }}\n"
)
NOT_DECIDED = Code(
    "R0807",
    title="a question about a rule was not decided",
    why="The product of automata can have too many states to search, and counts inside counts are "
    "not analysed. Objects to be counted are found one by one, so a question may also be left open "
    "if a count compares a number of each object with a number of something else, or if a fact is "
    "about two counted objects. The question is left open: the answer is not no.",
    bad=_NESTED.format(inner="some d: car (near(c, d))"),
    good=_NESTED.format(inner="near(c, c)"),
    kind="analyzed",
)


def undecided_diagnostic(rule: Rule, question: str, problem: UndecidedError) -> Diagnostic:
    """The warning (R0807) that a question about a rule was left open."""
    return NOT_DECIDED.at(
        rule.span,
        f"undecided for rule `{rule.name}` whether {question}: {problem}",
        help="split the rule: separate rules are analysed one by one",
        severity="warning",
    )
