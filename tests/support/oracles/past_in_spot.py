"""Formulas with a past for Spot, by another way than the compiler's.

Here a fresh proposition is the value of an operator of the past, where the compiler has a register
or what the instant before has left; and bounds are unrolled, where the compiler counts.
"""

from rulec.automata.alphabet import names_of
from rulec.logic.bounds import PAST, operations_of
from rulec.logic.formula import Atom, Binary, Unary, atoms_of
from rulec.logic.past_registers import eliminate_past
from support.generators.timed_formulas import without_bounds
from support.oracles.installed_spot import SpotFormulas, spot

DEFINITIONS = {
    "previously": "!{p} & G(({a} -> X{p}) & ({a} | X!{p}))",
    "weak previously": "{p} & G(({a} -> X{p}) & ({a} | X!{p}))",
    "once": "({p} <-> {a}) & G(X({p} <-> ({a} | {before})))",
    "historically": "({p} <-> {a}) & G(X({p} <-> ({a} & {before})))",
    "since": "({p} <-> {b}) & G(X({p} <-> ({b} | ({a} & {before}))))",
}
BEFORE = "!{before} & G(({p} -> X{before}) & ({p} | X!{before}))"


def in_spot(formula, alive=None):
    """The formula in Spot's syntax; it has no operators of the past."""
    return f"({SpotFormulas(names_of(atoms_of(formula)), alive).formula_of(formula)})"


def spot_automaton(formula, besides="1", alive=None):
    """Some automaton of the formula and of ``besides``, which is text for Spot.

    With ``alive`` of finite words, as long as that proposition is true."""
    definitions, fresh = [], []
    text = in_spot(_named(without_bounds(formula), definitions, fresh, alive), alive)
    language = spot.formula(" & ".join([text, f"({besides})", *definitions]))
    if alive is not None:
        language = spot.from_ltlf(language, alive)
    projection = spot.remove_ap()
    for name in fresh:
        projection.add_ap(name)
    # With a past that is guessed, the reductions by simulation that Spot makes unless told
    # otherwise can take for ever.
    return projection.strip(spot.translate(language, "low"))


def _named(formula, definitions, fresh, alive):
    match formula:
        case Unary(operator, operand):
            operands = (_named(operand, definitions, fresh, alive),)
        case Binary(operator, left, right):
            operands = tuple(_named(one, definitions, fresh, alive) for one in (left, right))
        case _:
            return formula
    if operator.value not in DEFINITIONS:
        return type(formula)(operator, *operands)
    value, before = (f"{kind} {len(fresh)}" for kind in ("value", "before"))
    fresh += [value, before]
    texts = {name: in_spot(one, alive) for name, one in zip("ab", operands, strict=False)}
    texts |= {"p": f'"{value}"', "before": f'"{before}"'}
    definitions.append(f"({DEFINITIONS[operator.value].format(**texts)})")
    definitions.append(f"({BEFORE.format(**texts)})")
    return Atom(value)


def is_easy(formula):
    """Spot takes for ever with many operators unrolled, and many past ones guessed.

    The compiler has it guess them even where unrolling leaves nothing: ``p then[<= 0 steps] q``.
    """
    operations = list(operations_of(without_bounds(formula)))
    n_guessed = sum(one.operator in PAST for one in operations)
    return len(operations) <= 20 and max(n_guessed, len(eliminate_past(formula).memories)) <= 3
