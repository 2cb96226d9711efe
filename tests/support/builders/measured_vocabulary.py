"""A vocabulary with numbers, and comparisons of them, for tests of what runs."""

from fractions import Fraction

from rulec.logic.formula import Comparison, Count, QuantityTerm, Same
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.vocabulary import Quantity as QuantityItem

MEASURED = Vocabulary(
    "measured",
    {"thing": ObjectType("thing"), "car": ObjectType("car", "thing")},
    {
        "place": Enumeration("place", ("thing",), ("near", "far", "gone")),
        "gap": QuantityItem("gap", ("thing",), "m"),
        "speed": QuantityItem("speed", (), "km/h", 50.0),
        "p": Signal("p", (), False),
        "q": Signal("q", ()),
    },
)

SPEED = QuantityTerm("speed")


def gap(variable):
    """The gap to an object, in m."""
    return QuantityTerm("gap", (variable,))


def number(text, relation, limit, *terms):
    """A comparison: ``terms`` are pairs of a coefficient, the first of them 1, and a term."""
    parts = tuple((Fraction(factor), term) for factor, term in terms)
    return Comparison(parts, relation, Fraction(limit), text)


def closer(variable, limit):
    """``gap(v) < limit``."""
    return number(f"gap({variable}) < {limit} m", "<", limit, (1, gap(variable)))


def others_near(variable):
    """How many other cars are near."""
    from support.builders.rulebooks import both, near, no

    return Count("x", "car", both(near("x"), no(Same("x", variable))))
