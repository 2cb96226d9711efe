"""Two rules side by side: which traces does one of them forbid, and the other allow?

A rule forbids a trace if it is violated for some objects. If it is, it is by the trace of these
objects alone, on the stretch on which they are there together; so traces of just the objects that a
rule speaks of tell whether another rule forbids all that it does. The other rule is asked about
these objects in all ways in which they fit its variables.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import permutations
from typing import Literal

from rulec.analysis.alphabet import Alphabet
from rulec.analysis.columns import machine_column
from rulec.analysis.common_words import common_words
from rulec.analysis.distinct import Side
from rulec.analysis.errors import UndecidedError
from rulec.analysis.scene import Scene
from rulec.analysis.search import shortest
from rulec.analysis.staging import alone, staged
from rulec.automata.compiled import CompiledRule
from rulec.automata.machine import NumberRead
from rulec.rulebook.model import Variable
from rulec.runtime.terms import names_in
from rulec.runtime.verify import verify
from rulec.trace import Trace
from rulec.vocabulary import Vocabulary

Relation = Literal["equal", "stricter", "laxer", "incomparable", "undecided"]
"""What the first rule is to the second one: stricter forbids all that the other does, and more."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """How two rules stand to each other.

    ``first_forbids`` is a shortest trace that the first rule forbids and the second one allows,
    ``second_forbids`` one the other way around; None where there is none. ``on_common`` is how they
    stand for objects that both of them speak of, given as ``common`` types, if one of them speaks
    of more. ``undecided`` says why a question was left open.
    """

    relation: Relation
    first_forbids: Trace | None = None
    second_forbids: Trace | None = None
    undecided: str = ""
    common: tuple[str, ...] = ()
    on_common: Relation | None = None


def compare(one: Side, other: Side) -> Comparison:
    """Compare two rules, both compiled for the same step if they have bounds in seconds."""
    if one.law == other.law:
        return Comparison("equal")
    found = _compare(one, other)
    common = common_types(one.rule.variables, other.rule.variables, one.rulebook.vocabulary)
    if common is None or found.undecided:
        return found
    narrowed = [_narrowed(side, common) for side in (one, other)]
    return replace(found, common=common, on_common=_compare(*narrowed).relation)


def _compare(one: Side, other: Side) -> Comparison:
    try:
        first, second = violation(one, [other]), violation(other, [one])
    except UndecidedError as problem:
        return Comparison("undecided", undecided=str(problem))
    return Comparison(relation_of(first, second), first, second)


def relation_of(first_forbids: object, second_forbids: object) -> Relation:
    """What the first rule is to the second, given what just one of them forbids, or None."""
    if first_forbids is None:
        return "equal" if second_forbids is None else "laxer"
    return "stricter" if second_forbids is None else "incomparable"


def violation(side: Side, others: Sequence[Side]) -> Trace | None:
    """A shortest trace that a rule forbids and all others allow; None if there is none.

    Raises UndecidedError.
    """
    scene = _scene(side, others)
    own = {variable.name: variable.name for variable in side.rule.variables}
    machines, wanted = [side.rule.machine], [False]
    columns = [machine_column(side.rule.machine, own, scene)]
    for other in others:
        for binding in scene.bindings(other.rule.variables):
            machines.append(other.rule.machine)
            columns.append(machine_column(other.rule.machine, binding, scene))
            wanted.append(True)
    alphabet = Alphabet(scene, columns)
    word = shortest(machines, wanted, alphabet.symbols)
    if word is None:
        return None
    forbidding = alone(side.rulebook, side.rule, scene)
    allowing = [alone(other.rulebook, other.rule, scene) for other in others]

    def shows(trace: Trace) -> bool:
        forbids = bool(verify(trace, forbidding).violations)
        return forbids and not any(verify(trace, one).violations for one in allowing)

    situations = [alphabet.situations[symbol] for symbol in word]
    steps = [one.rule.step_s for one in (side, *others) if one.rule.step_s is not None]
    return staged(situations, scene, (*steps, Fraction(1))[0], shows)


def _scene(side: Side, others: Sequence[Side]) -> Scene:
    """The objects that a rule speaks of, in the words of all the rulebooks."""
    sides = (side, *others)
    read = {name for one in sides for name in read_by(one.rule)}
    facts = tuple(dict.fromkeys(fact for one in sides for fact in one.facts))
    asked = read | {name for fact in facts for name in names_in(fact.formula)}
    vocabulary, unsaid = side.rulebook.vocabulary, frozenset[str]()
    for other in others:
        if other.rulebook.vocabulary == vocabulary:
            continue
        words = common_words(vocabulary, other.rulebook.vocabulary)
        for name in sorted(words.unlike & asked):
            raise UndecidedError(f"`{name}` is not declared alike in both")
        vocabulary, unsaid = words.vocabulary, unsaid | words.not_shared | words.unlike
    objects = {variable.name: variable.type for variable in side.rule.variables}
    return Scene(objects, vocabulary, facts, unsaid - read)


def read_by(rule: CompiledRule) -> frozenset[str]:
    """The declarations that a rule reads."""
    names: set[str] = set()
    for read in rule.machine.reads:
        if isinstance(read, NumberRead):
            names.update(name for _, term in read.terms for name in names_in(term))
        else:
            names.add(read.name)
    return frozenset(names)


def common_types(
    one: Sequence[Variable], other: Sequence[Variable], vocabulary: Vocabulary
) -> tuple[str, ...] | None:
    """The types of objects that both rules speak of, in the order of the first one's variables.

    None if the two speak of the same types, or share no objects at all.
    """
    types = [variable.type for variable in one]
    others = [variable.type for variable in other]
    if len(types) != len(others) or sorted(types) == sorted(others):
        return None
    for order in permutations(others):
        pairs = list(zip(types, order, strict=True))
        narrow = tuple(
            a if vocabulary.is_subtype(a, b) else b if vocabulary.is_subtype(b, a) else ""
            for a, b in pairs
        )
        if all(narrow):
            return narrow
    return None


def _narrowed(side: Side, common: tuple[str, ...]) -> Side:
    """The rule for objects of these types alone."""
    variables = side.rule.variables
    for order in permutations(common):
        if all(
            side.rulebook.vocabulary.is_subtype(kind, variable.type)
            for kind, variable in zip(order, variables, strict=True)
        ):
            own = tuple(
                Variable(variable.name, kind)
                for kind, variable in zip(order, variables, strict=True)
            )
            return replace(side, rule=replace(side.rule, variables=own))
    raise AssertionError("the common types are those of both rules")
