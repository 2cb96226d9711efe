"""Formulas with a past for Spot, by another way than the compiler's.

Here a fresh proposition is the value of an operator of the past, where the compiler's is what the
instant before has left; so each definition is another formula.
"""

import spot

from rulec.logic.formula import Atom, Binary, Unary
from rulec.logic.printing import in_spot

DEFINITIONS = {
    "previously": "!{p} & G(X{p} <-> {a})",
    "weak previously": "{p} & G(X{p} <-> {a})",
    "once": "({p} <-> {a}) & G(X{p} <-> (X{a} | {p}))",
    "historically": "({p} <-> {a}) & G(X{p} <-> (X{a} & {p}))",
    "since": "({p} <-> {b}) & G(X{p} <-> (X{b} | (X{a} & {p})))",
}


def spot_automaton(formula, besides="1"):
    """Some automaton of the formula and of ``besides``, which is text for Spot."""
    definitions = []
    text = in_spot(_named(formula, definitions))
    language = " & ".join([f"({text})", f"({besides})", *definitions])
    projection = spot.remove_ap()
    for number in range(len(definitions)):
        projection.add_ap(f"value {number}")
    return projection.strip(spot.translate(language))


def _named(formula, definitions):
    match formula:
        case Unary(operator, operand):
            operands = (_named(operand, definitions),)
        case Binary(operator, left, right):
            operands = (_named(left, definitions), _named(right, definitions))
        case _:
            return formula
    if operator.value not in DEFINITIONS:
        return type(formula)(operator, *operands)
    value = Atom(f"value {len(definitions)}")
    texts = {name: f"({in_spot(one)})" for name, one in zip("ab", operands, strict=False)}
    definition = DEFINITIONS[operator.value].format(p=in_spot(value), **texts)
    definitions.append(f"({definition})")
    return value
