"""How long one trace of ten million states takes, by formulas on random Booleans."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
from figure import Result
from program import run
from timing import in_turns, processor_time

from rulec.logic.formula import Atom, Binary, BinaryOperator, Bound, Unary, UnaryOperator
from rulec.monitoring.bits import along

LENGTH = 10_000_000
P, Q = Atom("p"), Atom("q")
RECENTLY = Unary(UnaryOperator.ONCE, P, Bound(Fraction(0), Fraction(20), "steps"))


def always(formula):
    return Unary(UnaryOperator.ALWAYS, formula)


FORMULAS = {
    "always (p implies eventually q)": always(
        Binary(BinaryOperator.IMPLIES, P, Unary(UnaryOperator.EVENTUALLY, Q))
    ),
    "always (p weak until q)": always(Binary(BinaryOperator.WEAK_UNTIL, P, Q)),
    "always (q implies once[<= 20 steps] p)": always(Binary(BinaryOperator.IMPLIES, Q, RECENTLY)),
}


def measure(rounds: int) -> Iterator[Result]:
    """Every formula."""
    chance = np.random.default_rng(1)
    columns = {P: chance.random(LENGTH) < 0.9, Q: chance.random(LENGTH) < 0.1}
    taken = in_turns(
        {
            name: processor_time(lambda one=one: along(one, LENGTH, columns.__getitem__), LENGTH)
            for name, one in FORMULAS.items()
        }
        | {"copying a column": processor_time(columns[P].copy, LENGTH)},
        rounds,
    )
    copy = taken.pop("copying a column")
    yield Result(
        "One long trace",
        f"{LENGTH:,} states from two Boolean columns, p mostly true and q seldom; per step",
        [one.figure(name, "ns", 1) for name, one in taken.items()]
        + [copy.figure("copying a column", "ns")],
    )


if __name__ == "__main__":
    run(measure, rounds=5)
