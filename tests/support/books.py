"""Rulebooks made in memory for tests of everything behind the language."""

from words import VOCABULARY

from rulec.logic.formula import Atom, Binary, BinaryOperator, Formula, Unary, UnaryOperator
from rulec.rulebook.model import Rule, Rulebook, Variable

P, Q = Atom("p"), Atom("q")


def near(variable: str) -> Atom:
    return Atom("place", (variable,), "near")


def far(variable: str) -> Atom:
    return Atom("place", (variable,), "far")


def no(formula: Formula) -> Formula:
    return Unary(UnaryOperator.NOT, formula)


def always(formula: Formula) -> Formula:
    return Unary(UnaryOperator.ALWAYS, formula)


def eventually(formula: Formula) -> Formula:
    return Unary(UnaryOperator.EVENTUALLY, formula)


def both(left: Formula, right: Formula) -> Formula:
    return Binary(BinaryOperator.AND, left, right)


def implies(left: Formula, right: Formula) -> Formula:
    return Binary(BinaryOperator.IMPLIES, left, right)


def rule(name, formula, *variables, strength="hard"):
    """A rule over variables given as ``"x: thing"``."""
    bound = (Variable(*text.split(": ")) for text in variables)
    return Rule(name, strength, tuple(bound), formula, cite=f"Art. {name}")


def book(*rules):
    return Rulebook("test", VOCABULARY, rules)
