"""Rules that cannot hold together from some state on, though each of them alone could."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from rulec.analysis.counterexample import declarations_read
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.logic.free_names import names_in
from rulec.monitoring.verify import verify
from rulec.rulebook.model import Variable
from rulec.trace import Trace
from rulec.vocabulary import Vocabulary
from rulec.witnesses.joint_alphabet import JointAlphabet, JointLetter
from rulec.witnesses.letter_functions import monitor_function
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.shortest_word import MOST_STATES, MOST_STEPS, ProductState
from rulec.witnesses.trace_synthesis import single_rule_rulebook, synthesize_trace
from rulec.witnesses.undecided import UndecidedError


@dataclass(frozen=True, slots=True)
class Conflict:
    """After ``trace`` every rule could be kept, but not all; None: they never hold together."""

    trace: Trace | None


@dataclass(frozen=True, slots=True)
class _Step:
    """The steps of a node that lead to one target and satisfy the same rules if the trace ends."""

    target: ProductState
    satisfied: frozenset[int]
    symbol: JointLetter


def conflict(sides: Sequence[AnalyzedRule]) -> Conflict | None:
    """A shortest trace after which the rules cannot all be kept any more, if there is one.

    Its objects are as few as the rules can speak of, each of one for its variables. The rules are
    of one rulebook. Raises UndecidedError where there is too much to search.
    """
    vocabulary = sides[0].rulebook.vocabulary
    scene = ObjectUniverse(
        common_objects([side.rule.variables for side in sides], vocabulary), vocabulary
    )
    scene = replace(scene, axioms=sides[0].axioms)
    bound = [
        (number, side.rule.machine, binding)
        for number, side in enumerate(sides)
        for binding in scene.bindings(side.rule.variables)
    ]
    columns = [monitor_function(machine, binding, scene) for _, machine, binding in bound]
    alphabet = JointAlphabet(scene, columns)
    if not alphabet.symbols:
        return None
    owners = [number for number, _, _ in bound]
    machines = [machine for _, machine, _ in bound]
    alone_ok = [
        _alone(
            [machine for owner, machine in zip(owners, machines, strict=True) if owner == number],
            [place for place, owner in enumerate(owners) if owner == number],
            alphabet.symbols,
        )
        for number in range(len(sides))
    ]
    graph = _explored(machines, owners, alphabet.symbols)
    everyone = frozenset(range(len(sides)))
    together = _hopeful(graph, everyone)
    places = [
        [place for place, owner in enumerate(owners) if owner == number]
        for number in range(len(sides))
    ]
    word = _shortest(graph, together, alone_ok, places, everyone)
    if word is None:
        return None
    if not word:
        return Conflict(None)
    steps = [side.rule.step_s for side in sides if side.rule.step_s is not None]
    judged = [single_rule_rulebook(side.rulebook, side.rule, scene) for side in sides]

    def is_open(trace: Trace) -> bool:
        violations = [violation for book in judged for violation in verify(trace, book).violations]
        return all(violation.step is None for violation in violations)

    situations = [alphabet.situations[symbol] for symbol in word]
    return Conflict(synthesize_trace(situations, scene, (*steps, Fraction(1))[0], is_open))


def are_related(one: AnalyzedRule, other: AnalyzedRule) -> bool:
    """Do two rules read something in common, or something that facts connect?"""
    reached = set(declarations_read(one.rule))
    groups = [set(names_in(fact.formula)) for fact in one.axioms]
    while joined := [group for group in groups if group & reached and not group <= reached]:
        reached.update(*joined)
    return bool(reached & declarations_read(other.rule))


def common_objects(
    heads: Sequence[Sequence[Variable]], vocabulary: Vocabulary
) -> Mapping[str, str]:
    """As few objects as every one of these rules has some to speak of."""
    objects: dict[str, str] = {}
    for variables in heads:
        free = list(objects)
        for variable in variables:
            result = next(
                (name for name in free if _fits(objects[name], variable, vocabulary)), None
            )
            if result is None:
                result = variable.name
                while result in objects:
                    result += "_"
                objects[result] = variable.type
            else:
                free.remove(result)
                if vocabulary.is_subtype(variable.type, objects[result]):
                    objects[result] = variable.type
    return objects


def _fits(kind: str, variable: Variable, vocabulary: Vocabulary) -> bool:
    return vocabulary.is_subtype(kind, variable.type) or vocabulary.is_subtype(variable.type, kind)


Graph = Mapping[ProductState, Sequence[_Step]]


def _explored(
    machines: Sequence[MealyMonitor], owners: Sequence[int], symbols: Sequence[JointLetter]
) -> Graph:
    """The joint states that can be reached, in breadth-first order; a rejecting sink ends it."""
    start: ProductState = (0,) * len(machines)
    graph: dict[ProductState, list[_Step]] = {}
    waiting = [start]
    seen = {start}
    for node in waiting:
        steps: dict[tuple[ProductState, frozenset[int]], _Step] = {}
        lost = any(a == machine.rejecting_sink for a, machine in zip(node, machines, strict=True))
        for symbol in () if lost else symbols:
            unsatisfied = {
                owner
                for owner, machine, state, which in zip(owners, machines, node, symbol, strict=True)
                if not machine.outputs[state][which]
            }
            target = tuple(
                machine.successors[state][which]
                for machine, state, which in zip(machines, node, symbol, strict=True)
            )
            key = (target, frozenset(owners) - unsatisfied)
            steps.setdefault(key, _Step(*key, symbol))
            if target not in seen:
                seen.add(target)
                waiting.append(target)
        graph[node] = list(steps.values())
        if len(seen) > MOST_STATES or len(graph) * len(symbols) > MOST_STEPS:
            raise UndecidedError("their automata together are too large")
    return graph


def _alone(
    machines: Sequence[MealyMonitor], places: Sequence[int], symbols: Sequence[JointLetter]
) -> frozenset[ProductState]:
    """The states of one rule's machines from which it can still be kept."""
    own = list(dict.fromkeys(tuple(symbol[place] for place in places) for symbol in symbols))
    graph = _explored(machines, [0] * len(machines), own)
    return _hopeful(graph, frozenset([0]))


def _hopeful(graph: Graph, everyone: frozenset[int]) -> frozenset[ProductState]:
    """The states from which some way on, of one step or more, satisfies everyone."""
    before: dict[ProductState, list[ProductState]] = {}
    for node, steps in graph.items():
        for step in steps:
            before.setdefault(step.target, []).append(node)
    waiting = [
        node for node, steps in graph.items() if any(step.satisfied >= everyone for step in steps)
    ]
    result = set(waiting)
    for node in waiting:
        for earlier in before.get(node, ()):
            if earlier not in result:
                result.add(earlier)
                waiting.append(earlier)
    return frozenset(result)


def _shortest(
    graph: Graph,
    together: frozenset[ProductState],
    alone_ok: Sequence[frozenset[ProductState]],
    places: Sequence[Sequence[int]],
    everyone: frozenset[int],
) -> tuple[JointLetter, ...] | None:
    """A shortest word, empty perhaps, after which each rule could be kept but not all."""

    def each_could(node: ProductState, satisfied: frozenset[int]) -> bool:
        return all(
            number in satisfied or tuple(node[place] for place in own) in hopeful
            for number, (own, hopeful) in enumerate(zip(places, alone_ok, strict=True))
        )

    start = next(iter(graph))
    if start not in together:
        return () if each_could(start, frozenset()) else None
    came: dict[ProductState, tuple[JointLetter, ...]] = {start: ()}
    waiting = [start]
    for node in waiting:
        for step in graph[node]:
            word = (*came[node], step.symbol)
            stuck = step.satisfied < everyone and step.target not in together
            if stuck and each_could(step.target, step.satisfied):
                return word
            if step.target not in came:
                came[step.target] = word
                waiting.append(step.target)
    return None
