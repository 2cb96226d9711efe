"""Numbers as written, with their units."""

from __future__ import annotations

import math
import re
from fractions import Fraction

from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases, constant
from rulec.rulebook.elaborate import elaboration_messages as say
from rulec.rulebook.elaborate.scope import Scope
from rulec.rulebook.names.declaration_messages import unknown_unit
from rulec.syntax import tree
from rulec.vocabulary.units import DIMENSIONS

_LONGEST = 400
"""Characters of a number; and what its exponent may be. Floats need fewer."""

_EXPONENT = re.compile(r"[eE]([+-]?[0-9]+)$")


def literal(node: tree.NumberLiteral, scope: Scope) -> NumberByCases | None:
    """Number literal with its unit; None after a reported mistake."""
    value = exact_value(node, scope)
    if value is None:
        return None
    if not node.unit:
        return constant(value, None if value == 0 else DIMENSIONS["number"], node.text)
    unit = scope.symbols.unit(node.unit)
    if unit is None:
        scope.report(unknown_unit(node.unit, node.span))
        return None
    return constant(value * unit.factor, unit.dimension, f"{node.text} {node.unit}")


def exact_value(node: tree.NumberLiteral, scope: Scope) -> Fraction | None:
    """Exact value of a number literal, without unit.

    None if it is too long, which is reported.
    """
    exponent = _EXPONENT.search(node.text)
    if len(node.text) <= _LONGEST and (exponent is None or abs(int(exponent[1])) <= _LONGEST):
        value = Fraction(node.text)
        if math.isfinite(float(node.text)):
            return value
    elif math.isfinite(float(node.text)):
        scope.report(say.too_long(node))
    # One that is too large has been reported where it was read.
    return None
