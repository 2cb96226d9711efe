"""The letters of a rule that some state has, by trying all values of all that it speaks of.

A sum of several numbers counts as a number of its own here, and a count as any number of objects:
what they have to do with each other and with the rest tells a rule nothing.
"""

from fractions import Fraction
from itertools import pairwise, permutations, product

from rulec.logic.formula import Atom, Binary, Comparison, Constant, Count, Unary, atoms_of
from rulec.vocabulary import Enumeration
from support.oracles.state_oracle import below, counts, joined, not_, stands


def possible_letters(formula, variables, rulebook):
    """Each is the set of the formula's propositions that are true in it."""
    axioms = [
        (fact.formula, names)
        for fact in rulebook.axioms
        if not counts(fact)
        for names in ways_to_say(fact, variables, rulebook.vocabulary)
    ]
    own = set(atoms_of(formula))
    spoken = own | {said_of(one, names) for fact, names in axioms for one in atoms_of(fact)}
    subjects = {}
    for one in spoken:
        subjects.setdefault(subject(one), []).append(one)
    cases = [
        {frozenset(one for one in ones if is_true(one, value)) for value in values(ones, rulebook)}
        for ones in subjects.values()
    ]
    whole = (frozenset().union(*parts) for parts in product(*cases))
    return frozenset(
        letter & own
        for letter in whole
        if all(holds(fact, names, letter) for fact, names in axioms)
    )


def ways_to_say(fact, variables, vocabulary):
    """A fact is said of all distinct variables of its types, or of types below them."""
    for chosen in permutations(variables, len(fact.variables)):
        if all(
            below(one.type, own.type, vocabulary.types)
            for one, own in zip(chosen, fact.variables, strict=True)
        ):
            yield {own.name: one.name for one, own in zip(chosen, fact.variables, strict=True)}


def said_of(proposition, names):
    """A proposition of a fact, about other variables."""
    if isinstance(proposition, Atom):
        arguments = tuple(names[one] for one in proposition.arguments)
        return Atom(proposition.name, arguments, proposition.value)
    terms = tuple(
        (factor, type(term)(term.name, tuple(names[one] for one in term.arguments)))
        for factor, term in proposition.terms
    )
    return Comparison(terms, proposition.relation, proposition.limit, proposition.text)


def subject(one):
    """What has a value that makes a proposition true or false."""
    return one.terms if isinstance(one, Comparison) else (one.name, one.arguments)


def values(propositions, rulebook):
    """Values enough to meet every combination of truths."""
    first = propositions[0]
    if isinstance(first, Atom):
        declaration = rulebook.vocabulary.declarations[first.name]
        return declaration.values if isinstance(declaration, Enumeration) else (True, False)
    limits = {one.limit for one in propositions}
    if len(first.terms) == 1 and isinstance(first.terms[0][1], Count):
        return [Fraction(n) for n in range(int(max(0, *limits)) + 2)]
    around = sorted({limit + shift for limit in limits for shift in (-1, 0, 1)})
    between = [(one + other) / 2 for one, other in pairwise(around)]
    return [*around, *between]


def is_true(proposition, value):
    if isinstance(proposition, Comparison):
        return stands(value, proposition.relation, proposition.limit)
    return value is True if proposition.value is None else value == proposition.value


def holds(fact, names, letter):
    match fact:
        case Atom() | Comparison():
            return said_of(fact, names) in letter
        case Constant(value):
            return value
        case Unary(_, operand):
            return not_(holds(operand, names, letter))
        case Binary(operator, left, right):
            return joined(operator.value, holds(left, names, letter), holds(right, names, letter))
    raise AssertionError(fact)
