"""Verdicts on traces with unknown values, by going through all of their completions."""

from dataclasses import replace
from itertools import combinations, product
from math import prod

from rulec.logic.free_names import names_in
from rulec.vocabulary import Enumeration, Quantity
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.oracles.formula_oracle import is_kept
from support.oracles.rulebook_oracle import Said
from support.oracles.state_oracle import Reading, as_facts_have_it


def unknown_places(trace):
    """State, name and objects of every value that is not known, with what it may be."""
    for number, state in enumerate(trace.states):
        for name, value in state.items():
            yield from _within(number, name, (), value)


def _within(number, name, objects, value):
    if value is UNKNOWN or isinstance(value, Interval):
        yield number, name, objects, value
    elif isinstance(value, dict):
        for one, inner in value.items():
            yield from _within(number, name, (*objects, one), inner)


def values_of(name, given, vocabulary, numbers):
    declaration = vocabulary.declarations[name]
    if isinstance(declaration, Enumeration):
        return list(declaration.values)
    if isinstance(declaration, Quantity):
        if given is UNKNOWN:
            return numbers
        return [n for n in numbers if given.low <= n <= given.high] + [given.low, given.high]
    return [False, True]


def put(state, name, objects, value):
    if not objects:
        return {**state, name: value}
    return {**state, name: put(state[name], objects[0], objects[1:], value)}


def unknown_together(trace, vocabulary):
    """The places of unknown values that are one choice, with what each may be, and its states."""
    together = {}
    for number, name, objects, given in unknown_places(trace):
        number_of = None if vocabulary.declarations[name].constant else number
        together.setdefault((number_of, name, objects), (given, []))[1].append(number)
    return together


def options_of(together, vocabulary, numbers):
    return [
        values_of(name, given, vocabulary, numbers) for (_, name, _), (given, _) in together.items()
    ]


def n_completions(trace, vocabulary, numbers):
    """How many there are, facts left aside."""
    return prod(map(len, options_of(unknown_together(trace, vocabulary), vocabulary, numbers)))


def completions(trace, vocabulary, numbers):
    """Pairs of chosen values, by place, and the trace that they make.

    A constant, which is unknown in all states or in none, has one value in all of them.
    """
    together = unknown_together(trace, vocabulary)
    options = options_of(together, vocabulary, numbers)
    for chosen in product(*options):
        states = list(trace.states)
        for (_, name, objects), value in zip(together, chosen, strict=True):
            for number in together[_, name, objects][1]:
                states[number] = put(states[number], name, objects, value)
        yield dict(zip(together, chosen, strict=True)), replace(trace, states=tuple(states))


def keeps_facts(book, trace):
    """Whether all facts hold of all who are there, in every state."""
    reading = Reading(book, trace)
    for fact in book.axioms:
        for objects, first, last in reading.choices(fact):
            for number in range(first, last + 1):
                letter = reading.letter(fact.formula, objects, number)
                if letter is not None and not is_kept(fact.formula, [letter], "finite"):
                    return False
    return True


class CompletionOracle:
    """What the completions of a trace come to, by rule and objects."""

    def __init__(self, oracle, trace, numbers):
        vocabulary = oracle.rulebook.vocabulary
        trace = as_facts_have_it(oracle.rulebook, trace)
        every = [
            (chosen, oracle.judged(whole))
            for chosen, whole in completions(trace, vocabulary, numbers)
            if keeps_facts(oracle.rulebook, whole)
        ]
        self.refused = [answer for _, answer in every if not isinstance(answer, tuple)]
        self.answers = [(chosen, answer) for chosen, answer in every if isinstance(answer, tuple)]
        self.read_by = {one.name: set(names_in(one.formula)) for one in oracle.rulebook.rules}
        self.names = [
            name
            for name in vocabulary.declarations
            if any(name == place[1] for chosen, _ in every for place in chosen)
        ]

    def outcomes(self, rule, objects):
        """Pairs of chosen values, and whether the rule is violated then, with the step."""
        for chosen, answer in self.answers:
            hits = [x for x in answer if x.rule == rule and x.objects == objects]
            yield chosen, hits[0] if hits else None

    def verdict(self, rule, objects):
        """``kept``, a violation, or ``open``."""
        outcomes = [said for _, said in self.outcomes(rule, objects)]
        if not any(outcomes):
            return "kept"
        if not all(outcomes):
            return "open"
        steps = [said.step for said in outcomes]
        step = -1 if -1 in steps else max(steps)
        return Said(rule, objects, step, outcomes[0].strength)

    def smallest(self, rule, objects):
        """The smallest set of the rule's own names that decides, the first of equally small ones.

        A fact may have others decide, too, of which the rule does not speak.
        """
        own = [name for name in self.names if name in self.read_by[rule]]
        for size in range(len(own) + 1):
            for names in combinations(own, size):
                if self.decides(names, rule, objects):
                    return names
        return None

    def decides(self, names, rule, objects):
        """Whether completions that agree on these names agree on the verdict."""
        known = {}
        for chosen, said in self.outcomes(rule, objects):
            key = tuple(value for place, value in chosen.items() if place[1] in names)
            if known.setdefault(key, bool(said)) != bool(said):
                return False
        return True
