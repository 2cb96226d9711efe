"""A shortest trace that one rule forbids and others allow.

A rule forbids a trace if it is violated for some objects. If it is, it is by the trace of these
objects alone, on the stretch on which they are there together; so traces of just the objects that a
rule speaks of tell whether another rule forbids all that it does. The other rule is asked about
these objects in all ways in which they fit its variables.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import NumberRead
from rulec.logic.free_names import names_in
from rulec.rulebook.rulebook_model import Axiom
from rulec.trace import Trace
from rulec.vocabulary import Declaration, ObjectType, Vocabulary
from rulec.witnesses.joint_alphabet import JointAlphabet
from rulec.witnesses.letter_functions import monitor_function
from rulec.witnesses.object_universe import Itself, ObjectUniverse
from rulec.witnesses.shortest_traces import shortest_word
from rulec.witnesses.trace_synthesis import synthesize_trace
from rulec.witnesses.undecided import UndecidedError


def counterexample(
    forbidding: AnalyzedRule, allowing: Sequence[AnalyzedRule], given: Sequence[Axiom] = ()
) -> Trace | None:
    """A shortest trace that only this rule forbids, or None.

    ``given`` is to hold in its states, besides what is known of any. Raises UndecidedError.
    """
    universe = _universe(forbidding, allowing, given)
    own = {variable.name: variable.name for variable in forbidding.rule.variables}
    bound = [(forbidding.rule.machine, own, False)]
    bound += [
        (allowed.rule.machine, binding, True)
        for allowed in allowing
        for binding in universe.bindings(allowed.rule.variables)
    ]
    monitors, bindings, verdicts = zip(*bound, strict=True)
    alphabet = JointAlphabet(universe, list(map(monitor_function, monitors, bindings)))
    word = shortest_word(monitors, verdicts, alphabet.candidates, alphabet.can_be_read)
    if word is None:
        return None

    def shows(trace: Trace) -> bool:
        return bool(forbidding.violations(trace, universe.vocabulary)) and not any(
            allowed.violations(trace, universe.vocabulary) for allowed in allowing
        )

    return synthesize_trace(
        alphabet.states_of(word), universe, common_step((forbidding, *allowing)), shows
    )


def common_step(rules: Iterable[AnalyzedRule]) -> Fraction:
    """Step of traces for rules with one step, in seconds; 1 where none matters."""
    return next((step for rule in rules if (step := rule.rule.step_s) is not None), Fraction(1))


def _universe(
    forbidding: AnalyzedRule, allowing: Sequence[AnalyzedRule], given: Sequence[Axiom]
) -> ObjectUniverse:
    rules = (forbidding, *allowing)
    read = {name for analyzed in rules for name in declarations_read(analyzed.rule)}
    axioms = tuple(dict.fromkeys((*(axiom for rule in rules for axiom in rule.axioms), *given)))
    names = read | {name for axiom in axioms for name in names_in(axiom.formula)}
    vocabulary, unsaid = forbidding.rulebook.vocabulary, frozenset[str]()
    for allowed in allowing:
        if allowed.rulebook.vocabulary == vocabulary:
            continue
        words = shared_vocabulary(vocabulary, allowed.rulebook.vocabulary)
        for name in sorted(words.unlike & names):
            raise UndecidedError(f"`{name}` is not declared alike in both")
        vocabulary, unsaid = words.vocabulary, unsaid | words.not_shared | words.unlike
    objects = {variable.name: variable.type for variable in forbidding.rule.variables}
    return ObjectUniverse(objects, vocabulary, axioms, unsaid - read)


def declarations_read(rule: CompiledRule) -> frozenset[str]:
    """The declarations that a rule reads."""
    names: set[str] = set()
    for read in rule.machine.reads:
        if isinstance(read, NumberRead):
            names.update(name for _, term in read.terms for name in names_in(term))
        else:
            names.add(read.name)
    return frozenset(names)


@dataclass(frozen=True, slots=True)
class SharedVocabulary:
    """The joint vocabulary of two rulebooks, with what one lacks or means otherwise."""

    vocabulary: Vocabulary
    not_shared: frozenset[str]
    unlike: frozenset[str]


def shared_vocabulary(first: Vocabulary, second: Vocabulary) -> SharedVocabulary:
    """The words of two vocabularies together.

    Where defaults differ there is none, so that traces say the value; what one calls constant or
    presumed and the other does not is neither. Raises UndecidedError.
    """
    return _shared_vocabulary(Itself(first), Itself(second))


# All rules of two rulebooks ask for the same one; what is known of its axioms is kept beside it.
@lru_cache(maxsize=8)
def _shared_vocabulary(one: Itself[Vocabulary], other: Itself[Vocabulary]) -> SharedVocabulary:
    first, second = one.item, other.item
    types: dict[str, ObjectType] = dict(first.types)
    for name, kind in second.types.items():
        if types.setdefault(name, kind).parent != kind.parent:
            raise UndecidedError(f"`{name}` is not the same type in both")
    declarations: dict[str, Declaration] = dict(first.declarations)
    unlike = set()
    for name, item in second.declarations.items():
        known = declarations.setdefault(name, item)
        if known == item:
            continue
        if _kind(known) != _kind(item):
            unlike.add(name)
        else:
            declarations[name] = replace(
                _kind(known) if known.default != item.default else known,
                constant=known.constant and item.constant,
                presumed=known.default == item.default and known.presumed and item.presumed,
            )
    not_shared = frozenset(first.declarations.keys() ^ second.declarations.keys())
    vocabulary = Vocabulary(first.name, types, declarations)
    return SharedVocabulary(vocabulary, not_shared, frozenset(unlike))


def _kind(item: Declaration) -> Declaration:
    return replace(item, default=None, constant=False, presumed=False)
