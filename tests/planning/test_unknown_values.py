"""Maneuvers where not all is known are judged as all completions of their traces come to."""

from dataclasses import replace
from fractions import Fraction
from itertools import islice, pairwise, product
from unittest.mock import patch

import pytest
from hypothesis import Phase, given, settings

import rulec
from rulec.api.named_monitor import Monitor
from rulec.automata.compiler import compile_rulebook
from rulec.logic.free_names import names_in
from rulec.planning.evaluation import evaluate
from rulec.planning.product import possible_instances
from rulec.trace import Trace, TraceGraph
from rulec.trace.trace_model import trace_of
from rulec.vocabulary import Quantity, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.full_vocabulary import WORLD
from support.builders.road_scenes import BEHIND_A_VAN
from support.builders.rulebooks import P, Q, always, book, compile_here, implies, no, rule
from support.builders.state_traces import as_trace
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


def with_states(graph, states):
    """The graph with other states of its nodes, given one after the other."""
    states = iter(states)
    return replace(graph, states=tuple(tuple(islice(states, len(row))) for row in graph.states))


def nodes_of(graph):
    return [state for layer in graph.states for state in layer]


def with_unknown(chance, graph, names):
    """The graph with some values of some nodes unknown, mostly of these names."""
    whole = Trace("", graph.step_s, graph.objects, tuple(nodes_of(graph)))
    return with_states(graph, blurred(chance, whole, names, most=4).states)


def untold(chance, graph, names):
    """The graph whose source cannot tell a name, and the one that says that it is unknown."""
    (dark,) = chance.sample(sorted(names), 1)
    without = [
        {name: value for name, value in state.items() if name != dark} for state in nodes_of(graph)
    ]
    each = unknown_of_each(WORLD.declarations[dark].parameters, graph.objects)
    said = [{**state, dark: each} for state in without]
    told = frozenset(WORLD.declarations) - {dark}
    return replace(with_states(graph, without), told=told), with_states(graph, said)


def unknown_of_each(kinds, objects):
    if not kinds:
        return UNKNOWN
    fitting = [name for name, own in objects.items() if WORLD.is_subtype(own, kinds[0])]
    return {name: unknown_of_each(kinds[1:], objects) for name in fitting}


def with_unknown_constants(chance, graph, names):
    """The graph all of whose nodes say the same of these names, of most that it is unknown."""
    first = nodes_of(graph)[0]
    said = {name: value for name, value in first.items() if name in names}
    for name in chance.sample(sorted(names), chance.randint(1, len(names))):
        said[name] = unknown_of_each(WORLD.declarations[name].parameters, graph.objects)
    others = [
        {name: value for name, value in state.items() if name not in names}
        for state in nodes_of(graph)
    ]
    return with_states(graph, [{**state, **said} for state in others])


def journey(graph, path):
    """The trace along a path, of those who are there."""
    trace = replace(trace_of(graph, path, ""), told=None)
    states = tuple(only(state, there(trace, n)) for n, state in enumerate(trace.states))
    return replace(trace, states=states)


def outcomes(book, shown, path):
    """By rule and objects: kept, open or violated; None if there are too many completions."""
    trace = journey(shown, path)
    many = islice(completions(trace, book.vocabulary, NUMBERS), MOST_COMPLETIONS, None)
    if next(many, None):
        return None
    completed = CompletionOracle(Oracle(book), trace, NUMBERS)
    assert not completed.refused
    found = {}
    for one in book.rules:
        for objects, _, _ in Reading(book, trace).choices(one):
            said = completed.verdict(one.name, tuple(objects.values()))
            word = "violated" if isinstance(said, Said) else said
            found[one.name, tuple(objects.values())] = word
    return found


def check(graph, shown, book):
    """Compare counts, lists and outcomes; ``shown`` is what ``graph`` is for who completes it."""
    every = [*islice(every_path(graph), MOST_PATHS + 1)]
    if len(every) > MOST_PATHS:
        return
    expected = {path: outcomes(book, shown, path) for path in every}
    if None in expected.values():
        return
    found = evaluate(Given(graph), compile_here(book, Fraction(1, 2)))
    dark = {one.rule for one in found.not_judged}
    hard = {one.name for one in book.rules if one.strength == "hard"}
    for path in every:
        expected[path] = {key: said for key, said in expected[path].items() if key[0] not in dark}

    def said_of(path):
        return {said for (name, _), said in expected[path].items() if name in hard}

    sure = [path for path in every if said_of(path) <= {"kept"}]
    perhaps = [path for path in every if "violated" not in said_of(path)]
    assert found.traces == len(every)
    listed = found.cheapest(MOST_PATHS, perhaps=True)
    known = {one.nodes for one in found.cheapest(MOST_PATHS)}
    if not found.exact:
        assert {*known} <= {*sure}
        assert {one.nodes for one in listed} >= {*perhaps}
        return
    assert found.satisfying == len(sure), (graph, book.rules)
    assert found.open == len(perhaps) - len(sure), (graph, book.rules)
    assert known == {*sure}
    assert {one.nodes for one in listed} == {*perhaps}
    for maneuver in listed:
        verdict = found.verdict(maneuver)
        if all(one.exact for one in verdict.open):
            said = {key_of(one): "violated" for one in verdict.violations}
            said |= {key_of(one): "open" for one in verdict.open}
            wanted = {key: x for key, x in expected[maneuver.nodes].items() if x != "kept"}
            assert said == wanted, (graph, maneuver)


def key_of(found):
    return found.rule, tuple(found.binding.values())


@given(seeds)
@settings(phases=[Phase.generate])
def test_counts_and_outcomes_are_those_of_all_paths_and_completions(chance):
    graph, rules, _ = scene(chance, False)
    names = {name for one in rules.rules for name in names_in(one.formula)}
    partial = with_unknown(chance, graph, names)
    check(partial, partial, rules)


@given(seeds)
@settings(phases=[Phase.generate])
def test_where_there_is_too_much_to_look_at_more_is_possible_and_said_to_be(chance):
    graph, rules, _ = scene(chance, False)
    names = {name for one in rules.rules for name in names_in(one.formula)}
    partial = with_unknown(chance, graph, names)
    with patch.object(possible_instances, "MOST_SETS", 1):
        check(partial, partial, rules)


@given(seeds)
@settings(phases=[Phase.generate])
def test_what_the_source_cannot_tell_is_unknown(chance):
    graph, rules, _ = scene(chance, False)
    names = {name for one in rules.rules for name in names_in(one.formula)}
    numbers = {name for name in names if isinstance(WORLD.declarations[name], Quantity)}
    if names - numbers:
        check(*untold(chance, graph, names - numbers), rules)


@given(seeds)
@settings(phases=[Phase.generate])
def test_constants_are_unknown_once_for_a_maneuver(chance):
    graph, rules, _ = scene(chance, False)
    names = {name for one in rules.rules for name in names_in(one.formula)}
    numbers = {name for name in names if isinstance(WORLD.declarations[name], Quantity)}
    if not names - numbers:
        return
    constants = set(chance.sample(sorted(names - numbers), 1))
    declarations = {
        name: replace(item, constant=name in constants) for name, item in WORLD.declarations.items()
    }
    rules = replace(rules, vocabulary=Vocabulary("world", WORLD.types, declarations))
    partial = with_unknown_constants(chance, graph, constants)
    check(partial, partial, rules)


def ladder(*layers):
    """Any node of a layer is followed by any of the next."""
    edges = tuple(((*range(len(after)),),) * len(before) for before, after in pairwise(layers))
    return TraceGraph(
        step_s=0.5,
        objects={},
        present={},
        states=layers,
        successors=edges,
        weights=edges,
        margins=edges,
        cost_unit=Fraction(1),
        start=0,
        goals=(*range(len(layers[-1])),),
    )


def test_counts_of_a_ladder_of_which_some_rungs_are_dark():
    """Sixty times a choice of three: of p it is known that it is, that it is not, or neither."""
    yes, dark, unsaid = ({"p": p, "q": True} for p in (True, UNKNOWN, False))
    graph = ladder((yes,), *[(yes, dark, unsaid)] * 60)
    found = evaluate(Given(graph), compile_rulebook(book(rule("p", always(P)))))
    assert (found.traces, found.satisfying, found.open) == (3**60, 1, 2**60 - 1)
    assert found.unknown == ("p",)
    (sure, first) = found.cheapest(2, perhaps=True)
    assert (found.verdict(sure).open, found.verdict(sure).violations) == ((), ())
    (doubt,) = found.verdict(first).open
    assert (doubt.rule, doubt.depends_on) == ("p", ("p",))


def test_what_nothing_depends_on_is_kept():
    dark = {"p": UNKNOWN, "q": True}
    graph = ladder((dark,), (dark, dark))
    rules = compile_rulebook(book(rule("either", always(implies(P, Q))), rule("not", no(no(Q)))))
    found = evaluate(Given(graph), rules)
    assert (found.traces, found.satisfying, found.open, found.exact) == (2, 2, 0, True)


def two_rules(strength):
    """The maneuvers of two layers by two rules, of which one is open in a third of the states.

    Costs are the numbers of the states in the second layer: of p and q false and false, false and
    true, open and false, open and true, true and false, true and true.
    """
    states = [{"p": p, "q": q} for p, q in product((False, UNKNOWN, True), (False, True))]
    rules = book(rule("p", always(P), strength=strength), rule("q", always(Q), strength=strength))
    graph = ladder(({"p": True, "q": True},), tuple(states))
    return evaluate(Given(graph), compile_rulebook(rules))


def test_ranks_are_of_what_is_sure_and_say_the_worst():
    found = two_rules("soft")
    ranked = found.ranked(10)
    sums = [(sum(one.at_least.values()), sum(one.penalty.values())) for one in ranked]
    # By what is surely violated, then by cost: 3 and 5; 1, 2 and 4; 0
    assert [one.maneuver.nodes[1] for one in ranked] == [3, 5, 1, 2, 4, 0]
    assert sums == [(0, 1), (0, 0), (1, 1), (1, 2), (1, 1), (2, 2)]
    assert [one.place for one in ranked] == [1, 1, 2, 2, 2, 3]
    assert [one.members for one in ranked] == [2, 2, 3, 3, 3, 1]
    prunings = {one.rule.name: (one.violating, one.open) for one in found.prunings()}
    assert prunings == {"p": (2, 2), "q": (3, 0)}


def test_what_keeps_every_hard_rule_comes_before_what_may_violate_one():
    ranked = two_rules("hard").ranked(10)
    # 5 satisfies; 3 is open; 1, 2 and 4 violate one rule, of which 2 may violate another; 0 two
    assert [one.maneuver.nodes[1] for one in ranked] == [5, 3, 1, 2, 4, 0]
    assert [one.place for one in ranked] == [1, 2, 3, 3, 3, 4]
    assert [one.members for one in ranked] == [1, 1, 3, 3, 3, 1]
    (best,) = two_rules("hard").best()
    assert best.maneuver.nodes[1] == 5


def test_how_many_hard_rules_are_open_does_not_count():
    """The cheaper of two maneuvers is open by both rules, the other by one; a third satisfies."""
    dark, half, sure = ({"p": p, "q": q} for p, q in ((UNKNOWN,) * 2, (UNKNOWN, True), (True,) * 2))
    rules = compile_rulebook(book(rule("p", always(P)), rule("q", always(Q))))
    for states, nodes in (((dark, half), [0, 1]), ((dark, half, sure), [2, 0, 1])):
        found = evaluate(Given(ladder(({"p": True, "q": True},), states)), rules)
        assert [one.maneuver.nodes[1] for one in found.ranked(5)] == nodes
        places = [one.place for one in found.ranked(5)]
        assert places == ([1, 1] if len(nodes) == 2 else [1, 2, 2])


PASSING = (
    BEHIND_A_VAN
    + """[[obstacle.prediction]]
weight = 0.7
speed = 4.0
[[obstacle.prediction]]
weight = 0.3
speed = 12.0
[signals]
CONGESTED = {}
"""
)


@pytest.fixture
def passing(tmp_path):
    def found(congested):
        path = tmp_path / "passing.toml"
        path.write_text(PASSING.format(congested), encoding="utf-8")
        return rulec.find_maneuvers(path, "esterle2019", horizon_s=2)

    return found


def test_counts_lie_between_those_of_both_values(passing):
    """R1 asks whether traffic is congested in the first state alone: one of the two is the case."""
    dark, yes, no_ = passing('"?"'), passing("true"), passing("false")
    assert (dark.traces, dark.open > 0, dark.unknown) == (yes.traces, True, ("CONGESTED",))
    assert (dark.satisfying, dark.open) == (no_.satisfying, yes.satisfying - no_.satisfying)
    worlds = [rulec.alternative_counts(found) for found in (dark, yes, no_)]
    for one, other, third in zip(*worlds, strict=True):
        assert (one.satisfying, one.open) == (third.satisfying, other.satisfying - third.satisfying)
    assert dark.classes().open == yes.classes().satisfying - no_.classes().satisfying


def test_probabilities_have_the_bounds_of_both_values(passing):
    dark, yes, no_ = passing('"?"'), passing("true"), passing("false")
    differing = 0
    for maneuver in dark.cheapest(100, perhaps=True):
        least, most = (rulec.rule_probabilities(found, maneuver) for found in (no_, yes))
        found = rulec.rule_probabilities(dark, maneuver)
        assert (found.clear, found.hard, found.hard_at_most) == (least.clear, least.hard, most.hard)
        for one, other, third in zip(found.rules, least.rules, most.rules, strict=True):
            assert (one.kept, one.at_most) == (other.kept, third.kept)
            differing += one.kept != one.at_most
    assert differing


def later_violations(oracle, trace, n_past):
    """Rules and objects whose violation is not decided by the end of the past."""
    last = len(trace.states) - 1
    for one in oracle.judged(trace):
        ends = min((trace.present[name][1] for name in one.objects), default=last)
        if (ends if one.step < 0 else one.step) >= n_past:
            yield one.rule, one.objects


@given(seeds)
@settings(phases=[Phase.generate])
def test_an_unknown_past_is_all_that_it_may_have_been(chance):
    graph, rules, past = scene(chance, True)
    every = [*islice(every_path(graph), MOST_PATHS + 1)]
    if len(every) > MOST_PATHS:
        return
    names = {name for one in rules.rules for name in names_in(one.formula)}
    whole = Trace("", graph.step_s, graph.objects, tuple(state for state, _ in past))
    dark = blurred(chance, whole, names, most=3).states
    begun = [(state, kinds) for state, (_, kinds) in zip(dark, past, strict=True)]
    compiled = compile_here(rules, Fraction(1, 2))
    monitor = Monitor(compiled, Fraction(1, 2))
    for state, kinds in begun:
        monitor.step(state, kinds)
    found = evaluate(Given(graph), compiled, monitor)
    if not found.in_doubt and chance.random() < 0.9:
        return
    hard = {one.name for one in rules.rules if one.strength == "hard"}
    # Whether each rule that some completion violates later is violated later by all.
    expected = {}
    oracle = Oracle(rules)
    for path in every:
        own = trace_of(graph, path, "")
        stays = [there(own, n) for n in range(len(own.states))]
        onward = [(only(*each), each[1]) for each in zip(own.states, stays, strict=True)]
        trace = as_trace([*begun, *onward], graph.step_s)
        if next(islice(completions(trace, WORLD, NUMBERS), MOST_COMPLETIONS, None), None):
            return
        each = [
            {*later_violations(oracle, complete, len(past))}
            for _, complete in completions(trace, WORLD, NUMBERS)
        ]
        about = {key for keys in each for key in keys if key[0] in hard}
        expected[path] = {all(key in keys for keys in each) for key in about}
    sure = {path for path in every if not expected[path]}
    perhaps = {path for path in every if True not in expected[path]}
    known = {one.nodes for one in found.cheapest(MOST_PATHS)}
    listed = found.cheapest(MOST_PATHS, perhaps=True)
    assert known <= sure
    assert {one.nodes for one in listed} >= perhaps
    if found.exact:
        assert known == sure, (graph, rules.rules, begun)
        assert {one.nodes for one in listed} == perhaps, (graph, rules.rules, begun)
    for one in listed:
        verdict = found.verdict(one)
        assert any(each.strength == "hard" for each in verdict.open) == (one.nodes not in known)
        assert not any(each.strength == "hard" for each in verdict.violations)


def test_the_verdict_on_a_maneuver_says_what_is_not_judged_where_all_else_is_known():
    found = rulec.find_maneuvers("s2", "esterle2019", told_only=True)
    verdict = found.verdict(found.cheapest(1)[0])
    # Nobody says whether traffic is congested
    assert [rule.rule for rule in verdict.not_judged] == ["R1"]
    assert verdict.satisfied is None
    assert not verdict.violations


def test_maneuvers_that_no_hard_rule_judges_keep_none():
    text = "rulebook flow use paper hard rule r { require always not CONGESTED }"
    rules = rulec.compile_rulebook(rulec.parse_rulebook(text))
    found = rulec.find_maneuvers("s2", rules, told_only=True)
    assert not found.judges
    assert "no hard rule can be judged" in repr(found)
