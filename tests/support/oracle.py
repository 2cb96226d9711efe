"""What a rulebook says of a trace, written down again from the documentation.

Variables are expanded, states are read and formulas evaluated here by loops over everything there
is. It shares no code with anything that judges in ``rulec``: all engines are compared with it.
"""

from dataclasses import dataclass

from definition import is_kept
from hope import Hope
from possible import possible_letters
from reading import Reading, number

from rulec.logic.formula import Binary, Bound, Unary


@dataclass(frozen=True, order=True)
class Said:
    """A rule is violated by these objects; ``step`` is -1 if only the end decides."""

    rule: str
    objects: tuple[str, ...]
    step: int
    strength: str


@dataclass(frozen=True)
class Refused:
    """There is no verdict, for one of the reasons with these codes."""

    codes: frozenset[str]


def judged(rulebook, trace):
    """All that is violated, sorted; or why nothing can be said."""
    if not trace.states:
        return Refused(frozenset({"R0506"}))
    reading = Reading(rulebook, trace)
    codes = {"R0508"} if reading.breaks_a_counting_fact() else set()
    found = []
    for rule in rulebook.rules:
        formula = in_steps(rule.formula, number(trace.step_s))
        letters = possible_letters(formula, rule.variables, rulebook)
        hope = Hope(formula, rulebook.semantics, letters)
        for objects, first, last in reading.choices(rule):
            word = [reading.letter(formula, objects, n) for n in range(first, last + 1)]
            if None in word:
                codes.add("R0504")
            elif not letters.issuperset(word):
                codes.add("R0508")
            elif not is_kept(formula, word, rulebook.semantics):
                lost = hope.first_lost(word)
                step = -1 if lost is None else first + lost
                found.append(Said(rule.name, tuple(objects.values()), step, rule.strength))
    return Refused(frozenset(codes)) if codes else tuple(sorted(found))


def in_steps(formula, step_s):
    """The formula with its bounds in steps of so many seconds."""
    match formula:
        case Unary(operator, operand, bound):
            return Unary(operator, in_steps(operand, step_s), steps_of(bound, step_s))
        case Binary(operator, left, right, bound):
            left, right = in_steps(left, step_s), in_steps(right, step_s)
            return Binary(operator, left, right, steps_of(bound, step_s))
    return formula


def steps_of(bound, step_s):
    if bound is None or bound.unit == "steps":
        return bound
    high = None if bound.high is None else bound.high / step_s
    return Bound(bound.low / step_s, high, "steps")
