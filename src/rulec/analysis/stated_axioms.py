"""Axioms that state what one declaration is, for all objects or for those of a read."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import lru_cache

from rulec.automata.alphabet import joined
from rulec.automata.mealy_monitor import Read
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary
from rulec.witnesses.object_universe import Itself


def said_of_constant(read: Read, vocabulary: Vocabulary) -> list[Axiom]:
    """Axioms that a constant has one value, for each distinguished value; the default first."""
    each: list[ltl.Formula] = [ltl.Atom(read.name, read.variables, value) for value in read.values]
    if not read.values:
        own = ltl.Atom(read.name, read.variables)
        each = [ltl.Unary(ltl.UnaryOperator.NOT, own), own]
    elif read.others:
        each.append(ltl.Unary(ltl.UnaryOperator.NOT, joined(ltl.BinaryOperator.OR, each)))
    default = vocabulary.declarations[read.name].default
    usual = None if default is None else read.digit(default)
    order = sorted(range(read.size), key=lambda digit: (digit != usual, digit))
    return [Axiom((), each[digit]) for digit in order]


# Cached, since facts derived from an axiom are stored with it, and many rules use the same words.
@lru_cache(maxsize=1024)
def said_as_usual(name: str, declared: Itself[Declaration]) -> Axiom:
    """The axiom that a declaration has its default, for all objects."""
    variables = _variables_of(declared.item)
    own = ltl.Atom(name, tuple(variable.name for variable in variables))
    match declared.item:
        case Enumeration(default=str(value)):
            return Axiom(variables, replace(own, value=value))
        case Signal(default=True):
            return Axiom(variables, own)
        case Signal():
            return Axiom(variables, ltl.Unary(ltl.UnaryOperator.NOT, own))
    assert declared.item.default is not None, "only what has a default can be as usual"
    return said_within(name, declared, "=", exact(float(declared.item.default)))


@lru_cache(maxsize=1024)
def said_within(
    name: str, declared: Itself[Declaration], relation: ltl.Relation, limit: Fraction
) -> Axiom:
    """The axiom that a quantity stands in a relation to a limit, for all objects."""
    variables = _variables_of(declared.item)
    term = ltl.QuantityTerm(name, tuple(variable.name for variable in variables))
    return Axiom(variables, ltl.Comparison(((Fraction(1), term),), relation, limit))


def _variables_of(declaration: Declaration) -> tuple[Variable, ...]:
    return tuple(Variable(f"o{number}", kind) for number, kind in enumerate(declaration.parameters))
