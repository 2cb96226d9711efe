"""Compare two rules by the traces that only one of them forbids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from typing import Literal

from rulec.analysis.counterexample import counterexample
from rulec.analysis.diff.diverse_witnesses import diverse_witnesses
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.rulebook.rulebook_model import Variable
from rulec.trace import Trace
from rulec.value_display import short_repr
from rulec.vocabulary import Vocabulary
from rulec.witnesses.undecided import UndecidedError

RuleRelation = Literal["equal", "stricter", "laxer", "incomparable", "undecided"]
"""What the first rule is to the second one: stricter forbids all that the other does, and more."""


@dataclass(frozen=True, slots=True)
class RuleComparison:
    """The relation of two rules to each other.

    ``first_forbids`` are traces that the first rule forbids and the second one allows, a shortest
    one first, then shortest ones for other reasons; ``second_forbids`` those the other way around.
    Both are empty where there are none. ``on_common`` is how they
    stand for objects that both of them speak of, given as ``common`` types, if one of them speaks
    of more. ``undecided`` says why a question was left open.
    """

    __repr__ = short_repr

    relation: RuleRelation
    first_forbids: tuple[Trace, ...] = ()
    second_forbids: tuple[Trace, ...] = ()
    undecided: str = ""
    common: tuple[str, ...] = ()
    on_common: RuleRelation | None = None


def compare(first: AnalyzedRule, second: AnalyzedRule, most: int = 1) -> RuleComparison:
    """Compare two rules, compiled for one step if bounds are in seconds.

    Either way ``most`` traces are looked for, each for a reason of its own.
    """
    if first.law == second.law:
        return RuleComparison("equal")
    comparison = _compare(first, second, most)
    common = common_types(first.rule.variables, second.rule.variables, first.rulebook.vocabulary)
    if common is None or comparison.undecided:
        return comparison
    narrow, narrower = (_narrowed(side, common) for side in (first, second))
    return replace(comparison, common=common, on_common=_compare(narrow, narrower, 1).relation)


def _compare(first: AnalyzedRule, second: AnalyzedRule, most: int) -> RuleComparison:
    try:
        first_trace, second_trace = counterexample(first, [second]), counterexample(second, [first])
    except UndecidedError as problem:
        return RuleComparison("undecided", undecided=str(problem))
    return RuleComparison(
        relation_of(first_trace, second_trace),
        () if first_trace is None else diverse_witnesses(first, second, first_trace, most),
        () if second_trace is None else diverse_witnesses(second, first, second_trace, most),
    )


def relation_of(first_forbids: object, second_forbids: object) -> RuleRelation:
    """The relation of two rules, from the traces that only one forbids.

    An argument is None if there is no such trace.
    """
    if first_forbids is None:
        return "equal" if second_forbids is None else "laxer"
    return "stricter" if second_forbids is None else "incomparable"


def common_types(
    first: Sequence[Variable], second: Sequence[Variable], vocabulary: Vocabulary
) -> tuple[str, ...] | None:
    """The object types of both rules, in order of the first's variables.

    None if the two speak of the same types, or share no objects at all.
    """
    types = [variable.type for variable in first]
    second_types = [variable.type for variable in second]
    if len(types) != len(second_types) or sorted(types) == sorted(second_types):
        return None
    for order in permutations(second_types):
        pairs = list(zip(types, order, strict=True))
        narrow = tuple(
            a if vocabulary.is_subtype(a, b) else b if vocabulary.is_subtype(b, a) else ""
            for a, b in pairs
        )
        if all(narrow):
            return narrow
    return None


def _narrowed(analyzed: AnalyzedRule, common: tuple[str, ...]) -> AnalyzedRule:
    """The rule for objects of these types alone."""
    variables = analyzed.rule.variables
    for order in permutations(common):
        if all(
            analyzed.rulebook.vocabulary.is_subtype(kind, variable.type)
            for kind, variable in zip(order, variables, strict=True)
        ):
            own = tuple(
                Variable(variable.name, kind)
                for kind, variable in zip(order, variables, strict=True)
            )
            return replace(analyzed, rule=replace(analyzed.rule, variables=own))
    raise AssertionError("the common types are those of both rules")
