"""How long compiling takes: the 169 patterns that Spot has collected from literature.

Each becomes a rule of its own and goes the whole way: translated, checked against the formula and
against its negation, made into a table and minimised, written as HOA.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import spot
from figure import Result
from program import run
from spot import gen
from timing import children_ms, in_turns, processor_time

from rulec.automata.alphabet import reads_of
from rulec.automata.compiler import compile_rulebook
from rulec.automata.compiler_jobs import Failed, Job
from rulec.automata.spot_bridge import COMPILER
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.vocabulary import Signal, Vocabulary
from support.asked_compilers import machine_by

FAMILIES = {
    "dac": gen.LTL_DAC_PATTERNS,
    "eh": gen.LTL_EH_PATTERNS,
    "hkrss": gen.LTL_HKRSS_PATTERNS,
    "p": gen.LTL_P_PATTERNS,
    "sb": gen.LTL_SB_PATTERNS,
}
UNARY = {
    spot.op_Not: UnaryOperator.NOT,
    spot.op_X: UnaryOperator.NEXT,
    spot.op_F: UnaryOperator.EVENTUALLY,
    spot.op_G: UnaryOperator.ALWAYS,
}
BINARY = {
    spot.op_And: BinaryOperator.AND,
    spot.op_Or: BinaryOperator.OR,
    spot.op_Implies: BinaryOperator.IMPLIES,
    spot.op_Equiv: BinaryOperator.IFF,
    spot.op_Xor: BinaryOperator.XOR,
    spot.op_U: BinaryOperator.UNTIL,
    spot.op_R: BinaryOperator.RELEASE,
    spot.op_W: BinaryOperator.WEAK_UNTIL,
    spot.op_M: BinaryOperator.STRONG_RELEASE,
}


def measure(rounds: int) -> Iterator[Result]:
    """Families one by one, all together, and all as one rulebook."""
    patterns = {
        name: [ours(one) for one in gen.ltl_patterns(family)] for name, family in FAMILIES.items()
    }
    every = [one for family in patterns.values() for one in family]
    book = rulebook(every)
    taken = in_turns(
        {
            **{name: processor_time(compiled(family), 1e6) for name, family in patterns.items()},
            "all": processor_time(compiled(every), 1e6),
            "process": lambda: with_children(lambda: compile_rulebook(book)),
        },
        rounds,
    )
    yield Result(
        "Compiling",
        f"the {len(every)} patterns of the literature in spot.gen, with all checks; altogether",
        [
            taken["all"].figure(f"all {len(every)} patterns", "ms", 1000),
            *(
                taken[name].figure(f"the {len(family)} of {name}", "ms")
                for name, family in patterns.items()
            ),
            taken["process"].figure("all as one rulebook, by a process of its own", "ms", 1000),
        ],
    )


def compiled(formulas: list[Formula]) -> Callable[[], None]:
    """What the worker does for each formula."""
    vocabulary = vocabulary_of(formulas)

    def work() -> None:
        for formula in formulas:
            job = Job("pattern", formula, reads_of(formula, vocabulary), (), "stutter", ())
            if isinstance(machine_by(job, COMPILER), Failed):
                raise RuntimeError(f"there is no machine of {formula}")

    return work


def ours(formula: spot.formula) -> Formula:
    """A formula of Spot's as one of rulec's."""
    kind = formula.kind()
    if kind in (spot.op_tt, spot.op_ff):
        return Constant(kind == spot.op_tt)
    if kind == spot.op_ap:
        return Atom(formula.ap_name())
    parts = [ours(one) for one in formula]
    if kind in UNARY:
        return Unary(UNARY[kind], parts[0])
    found = parts[0]
    for part in parts[1:]:
        found = Binary(BINARY[kind], found, part)
    return found


def rulebook(formulas: list[Formula]) -> Rulebook:
    """A rule for each formula."""
    rules = tuple(
        Rule(f"r{number}", "hard", (), formula) for number, formula in enumerate(formulas)
    )
    return Rulebook("patterns", vocabulary_of(formulas), rules)


def vocabulary_of(formulas: list[Formula]) -> Vocabulary:
    """A signal for each proposition."""
    names = sorted({atom.name for formula in formulas for atom in atoms_of(formula)})
    return Vocabulary("patterns", {}, {name: Signal(name, (), False) for name in names})


def with_children(work: Callable[[], object]) -> float:
    """Milliseconds of processor time, of this process and of those that it has started."""
    before = children_ms()
    here = processor_time(work, 1e6)()
    return here + children_ms() - before


if __name__ == "__main__":
    run(measure, rounds=5)
