"""What an engine is: something that judges traces, with answers in one normal form.

An engine takes a rulebook as meant, the same compiled, and traces. For each trace it says all that
is violated, sorted, as ``oracle.Said``; or with which code it was refused.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from rulec.diagnostics import RulecError
from rulec.monitoring.verdict import NotJudged
from support.oracles.rulebook_oracle import Refused, Said

STEPS = "the step from which on nothing helps"
OBJECTS = "the objects for which a rule is violated"
REFUSALS = "traces that there is no verdict on"
FORM = "states that do not fit the vocabulary"
EMPTY = "a trace without states"
ONE_STATE = "a trace of one state"
ANY_STEP = "a rulebook that knows one step"
MISFITS = {"R0501", "R0502", "R0503", "R0505"}


@dataclass(frozen=True)
class Engine:
    """``judge(rulebook, compiled, traces)`` gives an answer for each trace; ``lacks`` says why."""

    judge: Callable
    lacks: Mapping[str, str] = field(default_factory=dict)

    def takes(self, trace, expected):
        """Can it be asked about a trace that should come out like this?"""
        return not (
            (EMPTY in self.lacks and not trace.states)
            or (REFUSALS in self.lacks and isinstance(expected, Refused))
            or (ANY_STEP in self.lacks and expected == Refused(frozenset({"R0507"})))
            or (FORM in self.lacks and isinstance(expected, Refused) and expected.codes & MISFITS)
            or (ONE_STATE in self.lacks and len(trace.states) == 1)
        )

    def says(self, expected):
        """What it should say of a trace, as far as it can say it."""
        if isinstance(expected, Refused):
            return expected
        if OBJECTS in self.lacks:
            return tuple(sorted({one.rule for one in expected}))
        if STEPS in self.lacks:
            return tuple(sorted(replace(one, step=None) for one in expected))
        return expected


def told(answer):
    if isinstance(answer, NotJudged):
        return code_of(answer.error)
    return said(answer.violations)


def said(found):
    return tuple(
        sorted(
            Said(
                one.rule,
                tuple(one.binding.values()),
                -1 if one.step is None else one.step,
                one.strength,
            )
            for one in found
        )
    )


def code_of(error):
    return error.diagnostics[0].code


def each(judge_one):
    """An engine that knows one trace at a time, and raises what is wrong with it."""

    def answer(rulebook, compiled, trace):
        try:
            return judge_one(rulebook, compiled, trace)
        except RulecError as error:
            return code_of(error)

    return lambda rulebook, compiled, traces: [answer(rulebook, compiled, one) for one in traces]


def is_right(answer, expected):
    """Several things may be wrong with a trace at once; which of them is said is not agreed."""
    return answer in expected.codes if isinstance(expected, Refused) else answer == expected
