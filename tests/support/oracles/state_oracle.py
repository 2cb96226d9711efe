"""States as a rulebook's vocabulary reads them, written down again from the documentation."""

from dataclasses import replace
from fractions import Fraction
from itertools import product

from rulec.logic.formula import (
    Atom,
    Binary,
    Comparison,
    Constant,
    Count,
    QuantityTerm,
    Same,
    Unary,
    atoms_of,
)
from support.oracles.presence import there


def as_facts_have_it(rulebook, trace):
    """The trace in which states say, too, what facts make of a signal that they do not mention."""
    links = [
        (one.left, one.right)
        for one in (fact.formula for fact in rulebook.axioms)
        if isinstance(one, Binary) and one.operator.value == "implies"
        if isinstance(one.left, Atom) and isinstance(one.right, Atom)
        if (one.left.value, one.right.value) == (None, None)
        if one.left.arguments == one.right.arguments and one.left.name != one.right.name
        # What one state says of a constant holds in all, so none is filled in by one state
        if not {one.left.name, one.right.name} & {*rulebook.vocabulary.constants}
    ]
    if not links:
        return trace
    states = [dict(state) for state in trace.states]
    for state, (cause, effect) in product(states, links * len(links)):
        assert len(cause.arguments) < 2, "this reading knows of signals of one object only"
        said = state.get(cause.name)
        if not cause.arguments and said is True:
            state.setdefault(effect.name, True)
        if (
            cause.arguments
            and isinstance(said, dict)
            and isinstance(state.get(effect.name, {}), dict)
        ):
            follows = {item: True for item, value in said.items() if value is True}
            state[effect.name] = follows | state.get(effect.name, {})
    return replace(trace, states=tuple(states))


class Reading:
    """A trace as a rulebook's vocabulary reads it. What is neither given nor has a default is None.

    A part of a formula that depends on it is None, unless the rest decides.
    """

    def __init__(self, rulebook, trace):
        self.rulebook, self.trace = rulebook, trace
        self.types = rulebook.vocabulary.types
        self.declarations = rulebook.vocabulary.declarations
        self._there = [list(there(trace, n)) for n in range(len(trace.states))]

    def there(self, n):
        """The objects that are there in a state."""
        return self._there[n]

    def fits(self, name, kind):
        """Is an object of a type, or of one below it?"""
        return below(self.trace.objects[name], kind, self.types)

    def choices(self, rule):
        """Distinct objects for the rule's variables, and the first and last state with them all."""
        names = [one.name for one in rule.variables]
        for chosen in product(self.trace.objects, repeat=len(names)):
            fits = map(self.fits, chosen, [one.type for one in rule.variables])
            together = [
                n for n in range(len(self.trace.states)) if set(chosen) <= set(self.there(n))
            ]
            if all(fits) and len(set(chosen)) == len(chosen) and together:
                yield dict(zip(names, chosen, strict=True)), together[0], together[-1]

    def value(self, name, objects, n):
        value = self.trace.states[n].get(name)
        for one in objects:
            value = None if value is None else value.get(one)
        return self.declarations[name].default if value is None else value

    def letter(self, formula, objects, n):
        """The formula's propositions that are true in a state; None if it leaves one open."""
        truths = {one: self.truth(one, objects, n) for one in atoms_of(formula)}
        if None in truths.values():
            return None
        return frozenset(one for one, truth in truths.items() if truth)

    def truth(self, part, objects, n):
        match part:
            case Atom(name, arguments, wanted):
                value = self.value(name, [objects[one] for one in arguments], n)
                return None if value is None else value == (True if wanted is None else wanted)
            case Comparison(terms, relation, limit):
                values = [self.number(term, objects, n) for _, term in terms]
                if None in values:
                    return None
                total = sum(
                    factor * value for (factor, _), value in zip(terms, values, strict=True)
                )
                return stands(total, relation, limit)
            case Same(left, right):
                return objects[left] == objects[right]
            case Constant(value):
                return value
            case Unary(_, operand):
                inner = self.truth(operand, objects, n)
                return None if inner is None else not inner
            case Binary(operator, left, right):
                return joined(
                    operator.value, self.truth(left, objects, n), self.truth(right, objects, n)
                )

    def number(self, term, objects, n):
        match term:
            case QuantityTerm(name, arguments):
                value = self.value(name, [objects[one] for one in arguments], n)
                return None if value is None else number(value)
            case Count(variable, kind, body):
                truths = [
                    self.truth(body, {**objects, variable: name}, n)
                    for name in self.there(n)
                    if self.fits(name, kind)
                ]
                return None if None in truths else sum(truths)

    def breaks_a_counting_fact(self):
        """Is one false that speaks of what some rule reads?"""
        read = {name for rule in self.rulebook.rules for name in names_in(rule.formula)}
        return any(
            self.truth(fact.formula, objects, n) is False
            for fact in self.rulebook.axioms
            if counts(fact) and read & set(names_in(fact.formula))
            for objects, first, last in self.choices(fact)
            for n in range(first, last + 1)
        )


def below(kind, wanted, types):
    """Is a type another one, or below it?"""
    while kind not in (None, wanted):
        kind = types[kind].parent
    return kind == wanted


def joined(word, left, right):
    """Two truths joined by an operator, each True, False or None."""
    match word:
        case "and":
            return (
                False
                if left is False or right is False
                else None
                if None in (left, right)
                else True
            )
        case "or":
            return not_(joined("and", not_(left), not_(right)))
        case "implies":
            return joined("or", not_(left), right)
        case "iff":
            return None if None in (left, right) else left is right
        case "xor":
            return not_(joined("iff", left, right))
    raise AssertionError(word)


def not_(truth):
    return None if truth is None else not truth


def number(value):
    """A number as it is written: 0.1 is a tenth."""
    return value if isinstance(value, Fraction) else Fraction(str(value))


def stands(total, relation, limit):
    return {
        "<": total < limit,
        "<=": total <= limit,
        "=": total == limit,
        "!=": total != limit,
        ">=": total >= limit,
        ">": total > limit,
    }[relation]


def counts(fact):
    return any(
        isinstance(term, Count)
        for one in atoms_of(fact.formula)
        if isinstance(one, Comparison)
        for _, term in one.terms
    )


def names_in(part):
    """The names that a formula reads."""
    match part:
        case Atom(name) | QuantityTerm(name):
            yield name
        case Comparison(terms):
            for _, term in terms:
                yield from names_in(term.body if isinstance(term, Count) else term)
        case Unary(_, operand):
            yield from names_in(operand)
        case Binary(_, left, right):
            yield from names_in(left)
            yield from names_in(right)
