"""Formulas as text mean what they are."""

from hypothesis import given
from words import VOCABULARY, formulas

from rulec.logic.formula import Atom, atoms_of
from rulec.logic.printing import in_words
from rulec.rulebook.loader import parse_rulebook

DECLARATIONS = """
rulebook printed
type thing
type car is thing
place(t: thing) is one of near, far, gone
light is one of red, green default red
signal p default false
signal q
"""


@given(formulas)
def test_words_can_be_read_back(formula):
    variables = "(x: thing)" if any(atom.arguments for atom in atoms_of(formula)) else ""
    text = f"{DECLARATIONS}\nhard rule A {variables} {{ require {in_words(formula)} }}"
    (rule,) = parse_rulebook(text).rules
    assert rule.formula == formula


def test_the_declarations_are_those_of_the_formulas():
    vocabulary = parse_rulebook(f"{DECLARATIONS}\nhard rule A {{ require p }}").vocabulary
    assert vocabulary.declarations == VOCABULARY.declarations
    assert str(Atom("place", ("x",), "near")) == "near(x)"
