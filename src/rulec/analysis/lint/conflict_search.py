"""Rules that from some state on cannot hold together, only alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from rulec.analysis.counterexample import declarations_read
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.logic.free_names import names_in
from rulec.monitoring.verify import verify
from rulec.rulebook.rulebook_model import Variable
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
    """A trace after which each rule could be kept, but not all.

    If it is None, the rules never hold together.
    """

    trace: Trace | None


@dataclass(frozen=True, slots=True)
class _Step:
    """The steps from a node to one target that satisfy equal rules.

    The rules are those that are satisfied if the trace ends there.
    """

    target: ProductState
    satisfied: frozenset[int]
    symbol: JointLetter


def conflict(analyzed_rules: Sequence[AnalyzedRule]) -> Conflict | None:
    """A shortest trace after which not all rules can be kept.

    Its objects are as few as the rules can speak of, each of one for its variables. The rules are
    of one rulebook. Raises UndecidedError where there is too much to search.
    """
    vocabulary = analyzed_rules[0].rulebook.vocabulary
    objects = common_objects([rule.rule.variables for rule in analyzed_rules], vocabulary)
    universe = ObjectUniverse(objects, vocabulary, analyzed_rules[0].axioms)
    bound = [
        (number, analyzed.rule.machine, binding)
        for number, analyzed in enumerate(analyzed_rules)
        for binding in universe.bindings(analyzed.rule.variables)
    ]
    functions = [monitor_function(monitor, binding, universe) for _, monitor, binding in bound]
    alphabet = JointAlphabet(universe, functions)
    if not alphabet.letters:
        return None
    owners = [number for number, _, _ in bound]
    monitors = [monitor for _, monitor, _ in bound]
    alone_ok = [
        _alone(
            [monitor for owner, monitor in zip(owners, monitors, strict=True) if owner == number],
            [place for place, owner in enumerate(owners) if owner == number],
            alphabet.letters,
        )
        for number in range(len(analyzed_rules))
    ]
    graph = _explored(monitors, owners, alphabet.letters)
    all_rules = frozenset(range(len(analyzed_rules)))
    together = _hopeful(graph, all_rules)
    places = [
        [place for place, owner in enumerate(owners) if owner == number]
        for number in range(len(analyzed_rules))
    ]
    word = _shortest(graph, together, alone_ok, places, all_rules)
    if word is None:
        return None
    if not word:
        return Conflict(None)
    steps = [rule.rule.step_s for rule in analyzed_rules if rule.rule.step_s is not None]
    books = [
        single_rule_rulebook(analyzed.rulebook, analyzed.rule, universe)
        for analyzed in analyzed_rules
    ]

    def is_open(trace: Trace) -> bool:
        violations = [violation for book in books for violation in verify(trace, book).violations]
        return all(violation.step is None for violation in violations)

    states = [alphabet.states[letter] for letter in word]
    return Conflict(synthesize_trace(states, universe, (*steps, Fraction(1))[0], is_open))


def are_related(first: AnalyzedRule, second: AnalyzedRule) -> bool:
    """True if two rules share an input or are connected by axioms."""
    reached = set(declarations_read(first.rule))
    groups = [set(names_in(axiom.formula)) for axiom in first.axioms]
    while joined := [group for group in groups if group & reached and not group <= reached]:
        reached.update(*joined)
    return bool(reached & declarations_read(second.rule))


def common_objects(
    heads: Sequence[Sequence[Variable]], vocabulary: Vocabulary
) -> Mapping[str, str]:
    """The fewest objects that give every rule one to speak of."""
    objects: dict[str, str] = {}
    for variables in heads:
        free = list(objects)
        for variable in variables:
            chosen = next(
                (name for name in free if _fits(objects[name], variable, vocabulary)), None
            )
            if chosen is None:
                chosen = variable.name
                while chosen in objects:
                    chosen += "_"
                objects[chosen] = variable.type
            else:
                free.remove(chosen)
                if vocabulary.is_subtype(variable.type, objects[chosen]):
                    objects[chosen] = variable.type
    return objects


def _fits(kind: str, variable: Variable, vocabulary: Vocabulary) -> bool:
    return vocabulary.is_subtype(kind, variable.type) or vocabulary.is_subtype(variable.type, kind)


Graph = Mapping[ProductState, Sequence[_Step]]


def _explored(
    monitors: Sequence[MealyMonitor], owners: Sequence[int], letters: Sequence[JointLetter]
) -> Graph:
    """The reachable joint states in breadth-first order; a rejecting sink ends it."""
    start: ProductState = (0,) * len(monitors)
    graph: dict[ProductState, list[_Step]] = {}
    waiting = [start]
    seen = {start}
    for node in waiting:
        steps: dict[tuple[ProductState, frozenset[int]], _Step] = {}
        is_lost = any(
            a == monitor.rejecting_sink for a, monitor in zip(node, monitors, strict=True)
        )
        for letter in () if is_lost else letters:
            unsatisfied = {
                owner
                for owner, monitor, state, letter_class in zip(
                    owners, monitors, node, letter, strict=True
                )
                if not monitor.outputs[state][letter_class]
            }
            target = tuple(
                monitor.successors[state][letter_class]
                for monitor, state, letter_class in zip(monitors, node, letter, strict=True)
            )
            key = (target, frozenset(owners) - unsatisfied)
            steps.setdefault(key, _Step(*key, letter))
            if target not in seen:
                seen.add(target)
                waiting.append(target)
        graph[node] = list(steps.values())
        if len(seen) > MOST_STATES or len(graph) * len(letters) > MOST_STEPS:
            raise UndecidedError("their automata together are too large")
    return graph


def _alone(
    monitors: Sequence[MealyMonitor], places: Sequence[int], letters: Sequence[JointLetter]
) -> frozenset[ProductState]:
    """The states of one rule's machines from which it can be kept."""
    own = list(dict.fromkeys(tuple(letter[place] for place in places) for letter in letters))
    graph = _explored(monitors, [0] * len(monitors), own)
    return _hopeful(graph, frozenset([0]))


def _hopeful(graph: Graph, everyone: frozenset[int]) -> frozenset[ProductState]:
    """The states from which a word, not empty, satisfies every rule."""
    before: dict[ProductState, list[ProductState]] = {}
    for node, steps in graph.items():
        for step in steps:
            before.setdefault(step.target, []).append(node)
    waiting = [
        node for node, steps in graph.items() if any(step.satisfied >= everyone for step in steps)
    ]
    hopeful = set(waiting)
    for node in waiting:
        for earlier in before.get(node, ()):
            if earlier not in hopeful:
                hopeful.add(earlier)
                waiting.append(earlier)
    return frozenset(hopeful)


def _shortest(
    graph: Graph,
    together: frozenset[ProductState],
    alone_ok: Sequence[frozenset[ProductState]],
    places: Sequence[Sequence[int]],
    everyone: frozenset[int],
) -> tuple[JointLetter, ...] | None:
    """A shortest word after which only some rules can be kept.

    It may be empty.
    """

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
