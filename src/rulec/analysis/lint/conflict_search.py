"""Search for states from which rules can be kept only alone, not together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

from rulec.analysis.believable_states import plausible_states
from rulec.analysis.counterexample import common_step
from rulec.analysis.object_typings import answers_for_types
from rulec.analysis.possible_traces import is_possible, steadied
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.monitoring.uncertainty.known_words import KnownLetters
from rulec.rulebook.rulebook_model import Variable
from rulec.trace import Trace
from rulec.vocabulary import Vocabulary
from rulec.witnesses.joint_alphabet import JointAlphabet, JointLetter
from rulec.witnesses.letter_functions import LetterFunction, counts_read, monitor_function
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.relevant_axioms import ground_axioms, hold_by_default
from rulec.witnesses.shortest_words import MOST_STATES, MOST_STEPS, ProductState
from rulec.witnesses.trace_synthesis import synthesize_trace
from rulec.witnesses.undecided import UndecidedError


@dataclass(frozen=True, slots=True)
class Conflict:
    """A trace after which each rule could be kept, but not all; None if they never can be.

    That they never can be is so for all ``objects`` of some types, or, if it is None, for any.
    """

    trace: Trace | None
    objects: Mapping[str, str] | None = None


Graph = Mapping[ProductState, Mapping[tuple[ProductState, frozenset[int]], JointLetter]]
"""From each joint state the successors, with the rules satisfied if the trace ends there."""


def conflict(analyzed_rules: Sequence[AnalyzedRule]) -> Conflict | None:
    """A shortest trace after which not all rules can be kept.

    It has as few objects as possible, so that each rule applies to some. The rules are of one
    rulebook. Raises UndecidedError if the search is too large.
    """
    vocabulary = analyzed_rules[0].rulebook.vocabulary
    objects = common_objects([rule.rule.variables for rule in analyzed_rules], vocabulary)

    def search(own: Mapping[str, str]) -> Conflict | None:
        found = _conflict(analyzed_rules, ObjectUniverse(own, vocabulary, axioms))
        if found is not None and found.trace is not None:
            rules = [each.rule for each in analyzed_rules]
            within = (*axioms, *plausible_states(rules, vocabulary))
            with suppress(UndecidedError):
                plain = _conflict(analyzed_rules, ObjectUniverse(own, vocabulary, within))
                if plain and plain.trace and len(plain.trace.states) == len(found.trace.states):
                    return plain
        return found

    axioms = analyzed_rules[0].axioms
    problem: UndecidedError | None = None
    never: list[Mapping[str, str]] = []
    is_never = True
    for own, answer in answers_for_types(objects, analyzed_rules, vocabulary, search):
        if isinstance(answer, UndecidedError):
            problem = problem or answer
        elif answer is None:
            is_never = False
        elif answer.trace is not None:
            return answer
        else:
            never.append(own)
        if len(analyzed_rules) > 2 and not never:
            break  # only for pairs is it worth while to look for more
    if problem is not None:
        raise problem
    if not never:
        return None
    return Conflict(None) if is_never else Conflict(None, never[0])


def _conflict(analyzed_rules: Sequence[AnalyzedRule], universe: ObjectUniverse) -> Conflict | None:
    """The conflict for objects of these types."""
    bound = [
        (number, analyzed.rule, binding)
        for number, analyzed in enumerate(analyzed_rules)
        for binding in universe.bindings(analyzed.rule.variables)
    ]
    owners, monitors = [owner for owner, *_ in bound], [rule.machine for _, rule, _ in bound]
    functions = [monitor_function(rule.machine, binding) for _, rule, binding in bound]
    if have_harmless_state(monitors, functions, universe):
        return None
    alphabet = JointAlphabet(universe, functions)
    letters = alphabet.letters
    alphabet.require_complete()
    if not letters:
        return None
    rules = []
    for number in range(len(analyzed_rules)):
        places = [place for place, owner in enumerate(owners) if owner == number]
        own = dict.fromkeys(tuple(letter[place] for place in places) for letter in letters)
        alone = _explored([monitors[place] for place in places], [0] * len(places), list(own))
        rules.append((places, _hopeful(alone, frozenset([0]))))
    word = _shortest(_explored(monitors, owners, letters), rules)
    if not word:
        return None if word is None else Conflict(None)

    def is_open(trace: Trace) -> bool:
        return all(
            violation.step is None
            for analyzed in analyzed_rules
            for violation in analyzed.violations(trace, universe.vocabulary)
        )

    step, possible = common_step(analyzed_rules), partial(is_possible, universe=universe)
    trace = synthesize_trace(alphabet.states_of(word), universe, step, is_open, possible)

    def words(own: Trace) -> list[tuple[int, ...]]:
        known = KnownLetters(own, analyzed_rules[0].rulebook)
        return [known.word(rule, names, 0, len(word) - 1) for _, rule, names in bound]

    read = words(trace)
    return Conflict(
        steadied(trace, universe.vocabulary, lambda own: possible(own) and words(own) == read)
    )


def common_objects(
    heads: Sequence[Sequence[Variable]], vocabulary: Vocabulary
) -> Mapping[str, str]:
    """The fewest objects such that each rule applies to some."""
    objects: dict[str, str] = {}
    for variables in heads:
        free = list(objects)
        for variable in variables:
            fitting = [name for name in free if _fits(objects[name], variable, vocabulary)]
            if not fitting:
                name = variable.name
                while name in objects:
                    name += "_"
                objects[name] = variable.type
                continue
            free.remove(fitting[0])
            if vocabulary.is_subtype(variable.type, objects[fitting[0]]):
                objects[fitting[0]] = variable.type
    return objects


def _fits(kind: str, variable: Variable, vocabulary: Vocabulary) -> bool:
    return vocabulary.is_subtype(kind, variable.type) or vocabulary.is_subtype(variable.type, kind)


def _explored(
    monitors: Sequence[MealyMonitor], owners: Sequence[int], letters: Sequence[JointLetter]
) -> Graph:
    """The reachable joint states in breadth-first order, up to rejecting sinks."""
    start: ProductState = (0,) * len(monitors)
    everyone = frozenset(owners)
    graph: dict[ProductState, dict[tuple[ProductState, frozenset[int]], JointLetter]] = {}
    waiting = [start]
    seen = {start}
    for node in waiting:
        pairs = list(zip(monitors, node, strict=True))
        outputs = [monitor.outputs[state] for monitor, state in pairs]
        successors = [monitor.successors[state] for monitor, state in pairs]
        is_lost = any(state == monitor.rejecting_sink for monitor, state in pairs)
        steps = graph[node] = {}
        for letter in () if is_lost else letters:
            violated = {
                owner
                for owner, row, symbol in zip(owners, outputs, letter, strict=True)
                if not row[symbol]
            }
            target = tuple(row[symbol] for row, symbol in zip(successors, letter, strict=True))
            steps.setdefault((target, everyone - violated), letter)
            if target not in seen:
                seen.add(target)
                waiting.append(target)
        if len(seen) > MOST_STATES or len(graph) * len(letters) > MOST_STEPS:
            raise UndecidedError("their automata together are too large")
    return graph


def _hopeful(graph: Graph, everyone: frozenset[int]) -> frozenset[ProductState]:
    """The states from which some non-empty word satisfies every rule."""
    before: dict[ProductState, list[ProductState]] = {}
    waiting = []
    for node, steps in graph.items():
        for target, _ in steps:
            before.setdefault(target, []).append(node)
        if any(satisfied >= everyone for _, satisfied in steps):
            waiting.append(node)
    hopeful = set(waiting)
    for node in waiting:
        for earlier in before.get(node, ()):
            if earlier not in hopeful:
                hopeful.add(earlier)
                waiting.append(earlier)
    return frozenset(hopeful)


def _shortest(
    graph: Graph, rules: Sequence[tuple[Sequence[int], frozenset[ProductState]]]
) -> tuple[JointLetter, ...] | None:
    """A shortest word, possibly empty, after which only some of the rules can be kept.

    ``rules`` has, for each rule, the places of its machines and their states from which it can be
    kept.
    """
    everyone = frozenset(range(len(rules)))
    together = _hopeful(graph, everyone)

    def each_could(node: ProductState, satisfied: frozenset[int]) -> bool:
        return all(
            number in satisfied or tuple(node[place] for place in places) in hopeful
            for number, (places, hopeful) in enumerate(rules)
        )

    start = next(iter(graph))
    if start not in together:
        return () if each_could(start, frozenset()) else None
    words: dict[ProductState, tuple[JointLetter, ...]] = {start: ()}
    waiting = [start]
    for node in waiting:
        for (target, satisfied), letter in graph[node].items():
            word = (*words[node], letter)
            stuck = satisfied < everyone and target not in together
            if stuck and each_could(target, satisfied):
                return word
            if target not in words:
                words[target] = word
                waiting.append(target)
    return None


def have_harmless_state(
    monitors: Sequence[MealyMonitor], functions: Sequence[LetterFunction], universe: ObjectUniverse
) -> bool:
    """Whether some state is harmless to all monitors, whose letters the functions compute.

    False is inconclusive: states that depend on earlier ones may keep them together. Raises
    UndecidedError.
    """
    harmless = [harmless_classes(monitor) for monitor in monitors]
    if not all(harmless):
        return False
    contents = [
        LetterFunction(function.reads, tuple([int(symbol in own) for symbol in function.letters]))
        for function, own in zip(functions, harmless, strict=True)
    ]
    reads = [read for content in contents for read in content.reads]
    # Counts have no default: the universe's own objects may be among those counted.
    if (
        not counts_read(reads)
        and hold_by_default(contents, universe.vocabulary)
        and all(axiom.holds_by_default for axiom in ground_axioms(universe))
    ):
        return True
    return JointAlphabet(universe, contents).can_be_read((1,) * len(contents))


def harmless_classes(machine: MealyMonitor) -> frozenset[int]:
    """The letter classes that are accepted in every state from which the rule can be kept.

    Such states include those reached by an accepted letter, where the trace may end.
    """
    kept = {
        target
        for row, verdicts in zip(machine.successors, machine.outputs, strict=True)
        for target, verdict in zip(row, verdicts, strict=True)
        if verdict
    }
    kept |= {state for state, verdicts in enumerate(machine.outputs) if any(verdicts)}
    n_before = 0
    while len(kept) > n_before:
        n_before = len(kept)
        kept |= {state for state, row in enumerate(machine.successors) if not kept.isdisjoint(row)}
    classes = range(len(machine.outputs[0]))
    return frozenset(
        symbol for symbol in classes if all(machine.outputs[state][symbol] for state in kept)
    )
