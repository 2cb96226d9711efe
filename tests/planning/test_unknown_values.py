"""Maneuvers where not all is known are judged as all completions of their traces come to."""

from dataclasses import replace
from fractions import Fraction
from itertools import islice

from hypothesis import Phase, given, settings

from rulec.logic.free_names import names_in
from rulec.planning.maneuvers import evaluate
from rulec.trace import Trace
from rulec.trace.trace_model import trace_of
from support.builders.full_vocabulary import WORLD
from support.builders.rulebooks import compile_here
from support.generators.blurred_traces import blurred, telling_numbers
from support.generators.random_maneuvers import Given, scene
from support.generators.random_traces import only
from support.generators.seeds import seeds
from support.oracles.completion_oracle import CompletionOracle, completions
from support.oracles.maneuver_oracle import every_path
from support.oracles.presence import there
from support.oracles.rulebook_oracle import Oracle, Said
from support.oracles.state_oracle import Reading

NUMBERS = telling_numbers()
MOST_COMPLETIONS = 200
MOST_PATHS = 12


def with_unknown(chance, graph, names):
    """The graph with some values of some nodes unknown, the same dictionary for the same state."""
    nodes = [state for layer in graph.states for state in layer]
    whole = Trace("", graph.step_s, graph.objects, tuple(nodes))
    partial = iter(blurred(chance, whole, names, most=4).states)
    return replace(graph, states=tuple(tuple(islice(partial, len(row))) for row in graph.states))


def journey(graph, path):
    trace = trace_of(graph, path, "")
    states = tuple(only(state, there(trace, n)) for n, state in enumerate(trace.states))
    return replace(trace, states=states)


def outcomes(book, completed, trace, rules):
    """By rule and objects: ``kept``, ``open`` or ``violated``."""
    found = {}
    for rule in rules:
        for objects, _, _ in Reading(book, trace).choices(rule):
            said = completed.verdict(rule.name, tuple(objects.values()))
            found[rule.name, tuple(objects.values())] = (
                "violated" if isinstance(said, Said) else said
            )
    return found


@given(seeds)
@settings(phases=[Phase.generate])
def test_counts_and_outcomes_are_those_of_all_paths_and_completions(chance):
    graph, book, _ = scene(chance, False)
    every = [*islice(every_path(graph), MOST_PATHS + 1)]
    if len(every) > MOST_PATHS:
        return
    names = {name for rule in book.rules for name in names_in(rule.formula)}
    partial = with_unknown(chance, graph, names)
    oracle = Oracle(book)
    expected = {}
    for path in every:
        trace = journey(partial, path)
        if next(islice(completions(trace, WORLD, NUMBERS), MOST_COMPLETIONS, None), None):
            return
        completed = CompletionOracle(oracle, trace, NUMBERS)
        assert not completed.refused
        expected[path] = outcomes(book, completed, trace, book.rules)
    found = evaluate(Given(partial), compile_here(book, Fraction(1, 2)))
    hard = {rule.name for rule in book.rules if rule.strength == "hard"}

    def said_of(path):
        return {said for (rule, _), said in expected[path].items() if rule in hard}

    sure = [path for path in every if said_of(path) <= {"kept"}]
    perhaps = [path for path in every if "violated" not in said_of(path)]
    assert found.traces == len(every)
    assert found.satisfying == len(sure), (partial, book.rules)
    assert found.open == len(perhaps) - len(sure), (partial, book.rules)
    assert found.exact
    listed = found.cheapest(MOST_PATHS, perhaps=True)
    assert sorted(maneuver.nodes for maneuver in listed) == sorted(perhaps)
    assert sorted(one.nodes for one in found.cheapest(MOST_PATHS)) == sorted(sure)
    for maneuver in listed:
        verdict = found.verdict(maneuver)
        said = {(one.rule, tuple(one.binding.values())): "violated" for one in verdict.violations}
        said |= {(one.rule, tuple(one.binding.values())): "open" for one in verdict.open}
        wanted = {key: x for key, x in expected[maneuver.nodes].items() if x != "kept"}
        assert said == wanted, (partial, maneuver)
