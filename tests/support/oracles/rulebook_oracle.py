"""What a rulebook says of a trace, written down again from the documentation.

Variables are expanded, states are read and formulas evaluated here by loops over everything there
is. It shares no code with anything that judges in ``rulec``: all engines are compared with it.
"""

from dataclasses import dataclass
from fractions import Fraction

from rulec.logic.formula import Binary, Bound, Unary
from support.oracles.continuation_oracle import Hope
from support.oracles.formula_oracle import is_kept
from support.oracles.possible_letters import possible_letters
from support.oracles.state_oracle import Reading, as_facts_have_it, number


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


class Oracle:
    """Judges traces by a rulebook. What has been worked out for a word is remembered."""

    def __init__(self, rulebook):
        self.rulebook = rulebook
        self._known, self._letters = {}, {}

    def judged(self, trace):
        """All that is violated, sorted; or why nothing can be said."""
        if not trace.states:
            return Refused(frozenset({"R0506"}))
        reading = Reading(self.rulebook, as_facts_have_it(self.rulebook, trace))
        codes = {"R0508"} if reading.breaks_a_counting_fact() else set()
        found = []
        for rule in self.rulebook.rules:
            about = self._about(rule, number(trace.step_s))
            for objects, first, last in reading.choices(rule):
                word = [
                    self._letter(reading, rule.name, about.formula, objects, n)
                    for n in range(first, last + 1)
                ]
                wrong = {
                    "R0504" if one is None else "R0508" for one in word if one not in about.letters
                }
                codes |= wrong
                if not wrong and not about.keeps(word):
                    lost = about.first_lost(word)
                    step = -1 if lost is None else first + lost
                    found.append(Said(rule.name, tuple(objects.values()), step, rule.strength))
        return Refused(frozenset(codes)) if codes else tuple(sorted(found))

    def _letter(self, reading, name, formula, objects, n):
        # What was read of a state is kept with it, so that no other has its number meanwhile
        state, types = reading.trace.states[n], reading.trace.objects
        there = tuple((one, types[one]) for one in reading.there(n))
        key = name, tuple(objects.values()), id(state), there
        if key not in self._letters:
            self._letters[key] = reading.letter(formula, objects, n), state
        return self._letters[key][0]

    def _about(self, rule, step_s):
        if (rule.name, step_s) not in self._known:
            formula = in_steps(rule.formula, step_s)
            self._known[rule.name, step_s] = Meaning(formula, rule.variables, self.rulebook)
        return self._known[rule.name, step_s]


class Meaning:
    """A rule's formula, with the letters that are possible, on words of such letters."""

    def __init__(self, formula, variables, rulebook):
        self.formula, self._semantics = formula, rulebook.semantics
        self.letters = possible_letters(formula, variables, rulebook)
        self._hope = Hope(formula, rulebook.semantics, self.letters)
        self._kept, self._lost = {}, {}

    def keeps(self, word):
        key = tuple(word)
        if key not in self._kept:
            self._kept[key] = is_kept(self.formula, word, self._semantics)
        return self._kept[key]

    def first_lost(self, word):
        key = tuple(word)
        if key not in self._lost:
            self._lost[key] = self._hope.first_lost(word)
        return self._lost[key]


def in_steps(formula, step_s):
    """The formula with its bounds in steps of so many seconds, at which there is a state."""
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
    high = None if bound.high is None else Fraction(bound.high // step_s)
    return Bound(Fraction(-(-bound.low // step_s)), high, "steps")
