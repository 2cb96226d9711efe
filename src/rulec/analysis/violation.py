"""A shortest trace that one rule forbids and others allow.

A rule forbids a trace if it is violated for some objects. If it is, it is by the trace of these
objects alone, on the stretch on which they are there together; so traces of just the objects that a
rule speaks of tell whether another rule forbids all that it does. The other rule is asked about
these objects in all ways in which they fit its variables.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rulec.analysis.alphabet import Alphabet
from rulec.analysis.columns import machine_column
from rulec.analysis.distinct import Side
from rulec.analysis.errors import UndecidedError
from rulec.analysis.scene import Scene
from rulec.analysis.search import shortest
from rulec.analysis.shared_words import shared_words
from rulec.analysis.staging import alone, staged
from rulec.automata.compiled import CompiledRule
from rulec.automata.machine import NumberRead
from rulec.rulebook.model import Fact
from rulec.runtime.terms import names_in
from rulec.runtime.verify import verify
from rulec.trace import Trace


def violation(side: Side, others: Sequence[Side], given: Sequence[Fact] = ()) -> Trace | None:
    """A shortest trace that a rule forbids and all others allow; None if there is none.

    ``given`` is to hold in its states, besides what is known of any. Raises UndecidedError.
    """
    scene = _scene(side, others, given)
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


def _scene(side: Side, others: Sequence[Side], given: Sequence[Fact]) -> Scene:
    """The objects that a rule speaks of, in the words of all the rulebooks."""
    sides = (side, *others)
    read = {name for one in sides for name in read_by(one.rule)}
    facts = tuple(dict.fromkeys((*(fact for one in sides for fact in one.facts), *given)))
    asked = read | {name for fact in facts for name in names_in(fact.formula)}
    vocabulary, unsaid = side.rulebook.vocabulary, frozenset[str]()
    for other in others:
        if other.rulebook.vocabulary == vocabulary:
            continue
        words = shared_words(vocabulary, other.rulebook.vocabulary)
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
