"""The probabilities of a maneuver against a look at every world, cell by cell and point by point.

A world's scenario has one motion for each obstacle; where an obstacle is relative to a point of the
maneuver's cell is read off coordinates.
"""

from dataclasses import replace
from fractions import Fraction
from itertools import islice, product

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rulec import compile_rulebook
from rulec.diagnostics import RulecError
from rulec.monitoring import bindings
from rulec.monitoring.batch.verify import verify
from rulec.partition import navigation_graph
from rulec.planning import evaluate
from rulec.planning.probability import violation_events
from rulec.planning.probability.rule_probability import alternative_counts, rule_probabilities
from rulec.planning.product.graph_product import count_paths
from rulec.planning.ranking.cheapest import Maneuver
from rulec.rulebook.loader import parse_rulebook
from rulec.scenario import Alternative, ConstantAcceleration, Ego, Obstacle, Road, Scenario
from rulec.trace import Trace
from rulec.trace.trace_model import paths
from support.generators.random_scenarios import with_predictions
from support.oracles import partition_oracle as book

PAPER = compile_rulebook("esterle2019")
FINE = compile_rulebook(
    parse_rulebook(
        """
        rulebook passing
        use road
        signal CONGESTED
        hard rule on_the_left (v: road_user) {
          require not CONGESTED implies always not
            (behind(v) and next (behind(v) until beside(v) and right_of(v) until in_front_of(v)))
        }
        hard rule not_between (v: vehicle, w: road_user) {
          require always not (behind(v) and in_front_of(w))
        }
        soft rule room { require never (count v: vehicle (beside(v)) >= 2) }
        soft rule first (p: pedestrian) {
          require some v: vehicle (behind(v)) implies eventually not behind(p)
        }
        hard rule crossing_last { require never (crossing then not crossing) }
        """
    )
)
ALONE = ("R1", "R2", "R3", "on_the_left")
"""Rules about one object each."""

MOST_PATHS = 400
MOST_WORLDS = 30


def scene_of(scenario, **options):
    try:
        return navigation_graph(scenario, **options)
    except RulecError as error:
        assume([one.code for one in error.diagnostics] != ["R0607"])
        raise


def worlds(scenario):
    """Each with its probability: the motion of every obstacle."""
    choices = [
        [(one.weight, one.motion), *((other.weight, other.motion) for other in one.alternatives)]
        for one in scenario.obstacles
    ]
    assume(len(list(product(*choices))) <= MOST_WORLDS)
    for chosen in product(*choices):
        weight = Fraction(1)
        for part, _ in chosen:
            weight *= part
        yield (
            weight,
            [
                replace(one, motion=motion, alternatives=())
                for one, (_, motion) in zip(scenario.obstacles, chosen, strict=True)
            ],
        )


def relation(graph, obstacle, layer, point):
    """Where ego is: None if the obstacle is not on the road, "hit" if it is here."""
    start, end = float(graph.step * layer), float(graph.step * (layer + 1))
    found = book.taken(graph.scenario, obstacle, start, end, graph.partition, graph.extent)
    if found is None:
        return None
    (s0, s1, d0, d1), _ = found
    if s0 < point.x < s1 and d0 < point.y < d1:
        return "hit"
    around = book.regions(*found, graph.partition)
    return next(name for name, region in around.items() if region.contains(point))


def middle(cell):
    box = cell.boxes[0]
    return book.shapely.Point((box.s_min + box.s_max) / 2, (box.d_min + box.d_max) / 2)


def lived_through(graph, path, obstacles):
    """The trace in a world, and the names of those that hit ego. A new stretch has a new name."""
    traces = graph.trace_graph()
    states = [dict(traces.states[p][i]) for p, i in enumerate(path)]
    names = ("position",) if graph.partition == "paper" else ("station", "lateral")
    for state in states:
        state.update({name: {} for name in names})
        state.pop("oncoming", None)
    objects, present, hit = {}, {}, set()
    for obstacle in obstacles:
        before, number, name = None, 0, ""
        for p, i in enumerate(path):
            here = relation(graph, obstacle, p, middle(graph.layers[p].cells[i]))
            if here is not None:
                if before is None:
                    number += 1
                    name = f"{obstacle.id}.{number}"
                    objects[name] = obstacle.type
                    present[name] = (p, p)
                present[name] = (present[name][0], p)
                if obstacle.signals:
                    states[p].setdefault("oncoming", {})[name] = obstacle.signals["oncoming"]
                if here == "hit":
                    hit.add(name)
                else:
                    values = (here,) if graph.partition == "paper" else here
                    for key, value in zip(names, values, strict=True):
                        states[p][key][name] = value
            before = here
    for state in states:
        for name in {*names, "oncoming"} & state.keys():
            state[name] = {item: value for item, value in state[name].items() if item not in hit}
    return Trace("t", graph.step_s, objects, tuple(states), present), hit


def kept_in(world, rules):
    """Rule -> is it kept for all objects in a world; and whether all hard ones are, unhurt."""
    trace, hit = world
    unhurt = {name: kind for name, kind in trace.objects.items() if name not in hit}
    there = {name: span for name, span in trace.present.items() if name not in hit}
    broken = {
        one.rule for one in verify(replace(trace, objects=unhurt, present=there), rules).violations
    }
    return {
        rule.name: rule.name not in broken and not touched(rule, trace, hit, rules)
        for rule in rules.rules
    }


def spared(rule, obstacle, world, rules):
    """Is the rule kept for one obstacle?"""
    trace, hit = world
    about = {name for name in trace.objects if name.split(".")[0] == obstacle}
    unhurt = {name: kind for name, kind in trace.objects.items() if name not in hit}
    there = {name: span for name, span in trace.present.items() if name not in hit}
    verdict = verify(replace(trace, objects=unhurt, present=there), rules)
    broken = {
        name for one in verdict.violations if one.rule == rule for name in one.binding.values()
    }
    kind = next(iter({trace.objects[name] for name in about}), "")
    speaks_of = kind in rules.vocabulary.types and any(
        rules.vocabulary.is_subtype(kind, variable.type)
        for one in rules.rules
        if one.name == rule
        for variable in one.variables
    )
    return not (about & broken) and not (speaks_of and about & hit)


def touched(rule, trace, hit, rules):
    """Does one of those who hit ego play a part in the rule?"""
    fits = rules.vocabulary.is_subtype

    def meets(one, other):
        (a, b), (c, d) = trace.present[one], trace.present[other]
        return max(a, c) <= min(b, d)

    types = [variable.type for variable in rule.variables]
    for name in hit:
        kind = trace.objects[name]
        if rule.name in ("room", "no_company", "in_turn") and fits(kind, "vehicle"):
            return True
        if rule.name == "first" and any(fits(one, "pedestrian") for one in trace.objects.values()):
            if fits(kind, "vehicle") or fits(kind, "pedestrian"):
                return True
        elif len(types) == 1 and fits(kind, types[0]):
            return True
        elif len(types) == 2:
            for mine, others in (types, reversed(types)):
                if fits(kind, mine) and any(
                    other != name and fits(whose, others) and meets(name, other)
                    for other, whose in trace.objects.items()
                ):
                    return True
    return False


@given(
    with_predictions(),
    st.sampled_from(["paper", "fine"]),
    st.sampled_from(["lane", "body"]),
    st.data(),
)
def test_they_are_the_sums_over_all_worlds(scenario, partition, extent, data):
    graph = scene_of(scenario, partition=partition, extent=extent)
    rules = PAPER if partition == "paper" else FINE
    found = evaluate(graph, rules)
    assume(0 < found.traces <= MOST_PATHS)
    path = data.draw(st.sampled_from(list(paths(graph.trace_graph()))))
    told = rule_probabilities(found, Maneuver(path, 0.0, None))
    expected = dict.fromkeys((rule.name for rule in rules.rules), Fraction(0))
    of_one = {(rule, one.id): Fraction(0) for rule in ALONE for one in scenario.obstacles}
    clear = hard = Fraction(0)
    for weight, obstacles in worlds(scenario):
        world = lived_through(graph, path, obstacles)
        kept = kept_in(world, rules)
        for name, whether in kept.items():
            expected[name] += weight * whether
        for key in of_one:
            of_one[key] += weight * spared(*key, world, rules)
        clear += weight * (not world[1])
        hard += weight * (
            not world[1] and all(kept[one.name] for one in rules.rules if one.strength == "hard")
        )
    assert {one.rule.name: one.kept for one in told.rules} == expected
    assert (told.clear, told.hard) == (clear, hard)
    assert {
        (one.rule.name, *each.binding.values()): each.kept
        for one in told.rules
        if one.rule.name in ALONE
        for each in one.bindings
    } == {key: kept for key, kept in of_one.items() if kept < 1 and key[0] in expected}
    pairs = [each for one in told.rules for each in one.bindings]
    assert all(0 <= each.kept < 1 for each in pairs)
    assert all(len(set(each.binding.values())) == len(each.binding) for each in pairs)


@given(with_predictions(most=2), st.sampled_from(["paper", "fine"]))
def test_counts_in_other_worlds_are_those_of_all_paths(scenario, partition):
    graph = scene_of(scenario, partition=partition)
    rules = PAPER if partition == "paper" else FINE
    found = evaluate(graph, rules)
    assume(0 < found.traces <= MOST_PATHS // 4)
    for one in alternative_counts(found):
        obstacles = [
            replace(other, motion=other.alternatives[one.number - 1].motion)
            if other.id == one.obstacle
            else other
            for other in scenario.obstacles
        ]
        clear = [
            trace
            for path in paths(graph.trace_graph())
            for trace, hit in [lived_through(graph, path, obstacles)]
            if not hit
        ]
        assert one.traces == len(clear)
        hard = {rule.name for rule in rules.rules if rule.strength == "hard"}
        satisfying = [
            trace
            for trace in clear
            if hard.isdisjoint(lost.rule for lost in verify(trace, rules).violations)
        ]
        assert one.satisfying == len(satisfying)


@given(with_predictions(), st.sampled_from(["paper", "fine"]))
def test_without_other_predictions_all_is_certain(scenario, partition):
    certain = replace(
        scenario,
        obstacles=tuple(
            replace(one, weight=Fraction(1), alternatives=()) for one in scenario.obstacles
        ),
    )
    graph = scene_of(certain, partition=partition)
    found = evaluate(graph, PAPER if partition == "paper" else FINE)
    assume(found.traces)
    for maneuver in found.cheapest(3):
        told = rule_probabilities(found, maneuver)
        assert (told.clear, told.hard) == (1, 1)
    assert alternative_counts(found) == []
    assert count_paths(graph.trace_graph()) == found.traces


COUNTING = compile_rulebook(
    parse_rulebook(
        """
        rulebook counting
        use road
        hard rule room { require never (count v: vehicle (beside(v)) >= 2) }
        hard rule no_company (v: vehicle) {
          require never (beside(v) and some w: vehicle (behind(w)))
        }
        soft rule in_turn (v: vehicle) {
          require never (some w: vehicle (behind(w) and oncoming(v)) then in_front_of(v))
        }
        """
    )
)


@st.composite
def beside_a_queue(draw):
    """Ego on the right of two lanes; others stand or drive in the left one, nobody knows where."""
    moving = st.builds(
        ConstantAcceleration,
        st.sampled_from([6.0, 14.0, 20.0, 26.0, 34.0]),
        st.just(4.5),
        st.sampled_from([0.0, 0.0, 4.0, -8.0]),
    )
    others = []
    for number in range(draw(st.integers(2, 4))):
        first, *rest = draw(st.lists(moving, min_size=1, max_size=3, unique=True))
        share = Fraction(1, len(rest) + 1)
        others.append(
            Obstacle(
                f"o{number}",
                "vehicle",
                4.0,
                1.8,
                first,
                signals={"oncoming": draw(st.booleans())},
                weight=share,
                alternatives=tuple(Alternative(share, one) for one in rest),
            )
        )
    road = Road((0.0, 40.0), (0.0, 3.0, 6.0))
    return Scenario("queue", road, Ego(20.0, 1.5), tuple(others), horizon_s=2.0)


@given(beside_a_queue(), st.data())
def test_of_rules_that_count_too(scenario, data):
    graph = navigation_graph(scenario, partition="fine")
    assume(count_paths(graph.trace_graph()))
    path = data.draw(st.sampled_from(list(islice(paths(graph.trace_graph()), 100))))
    told = rule_probabilities(evaluate(graph, COUNTING), Maneuver(path, 0.0, None))
    expected = dict.fromkeys((rule.name for rule in COUNTING.rules), Fraction(0))
    hard = Fraction(0)
    for weight, obstacles in worlds(scenario):
        world = lived_through(graph, path, obstacles)
        kept = kept_in(world, COUNTING)
        for name, whether in kept.items():
            expected[name] += weight * whether
        hard += weight * (kept["room"] and kept["no_company"] and not world[1])
    assert {one.rule.name: one.kept for one in told.rules} == expected
    assert told.hard == hard


def test_where_too_many_worlds_make_a_difference_it_is_not_known(monkeypatch):
    monkeypatch.setattr(violation_events, "MOST_WORLDS", 3)
    places = [ConstantAcceleration(s, 4.5) for s in (6.0, 20.0)]
    half = Fraction(1, 2)
    others = tuple(
        Obstacle(
            f"o{number}",
            "vehicle",
            4.0,
            1.8,
            places[0],
            signals={"oncoming": False},
            weight=half,
            alternatives=(Alternative(half, places[1]),),
        )
        for number in range(2)
    )
    road = Road((0.0, 40.0), (0.0, 3.0, 6.0))
    scenario = Scenario("queue", road, Ego(20.0, 1.5), others)
    found = evaluate(navigation_graph(scenario, partition="fine"), COUNTING)
    told = rule_probabilities(found, Maneuver((found.graph.start,) * 5, 0.0, None))
    room = told.rules[0]
    assert (room.rule.name, room.kept, room.bindings) == ("room", None, ())
    assert told.hard is None
    assert told.clear == 1


def test_what_was_before_counts_whatever_comes_true():
    """Ego was behind o1, which has turned off to the left, or, less likely, has not."""
    rules = compile_rulebook(
        parse_rulebook(
            "rulebook r\nuse paper\n"
            "hard rule behind_stays (v: vehicle) { require never (b(v) then r(v)) }"
        )
    )
    aside, ahead = ConstantAcceleration(20.0, 4.5), ConstantAcceleration(20.0, 1.5)
    o1 = Obstacle(
        "o1",
        "vehicle",
        4.0,
        1.8,
        aside,
        weight=Fraction(3, 5),
        alternatives=(Alternative(Fraction(2, 5), ahead),),
    )
    road = Road((0.0, 40.0), (0.0, 3.0, 6.0))
    graph = navigation_graph(Scenario("turned", road, Ego(5.0, 1.5), (o1,)))
    past = Trace("past", 1.0, {"o1": "vehicle"}, ({"position": {"o1": "b"}, "surface": "R_cw"},))
    stays = Maneuver((graph.start,) * len(graph.layers), 0.0, None)
    assert rule_probabilities(evaluate(graph, rules), stays).hard == 1
    found = evaluate(graph, rules, past)
    assert found.satisfying == 0
    told = rule_probabilities(found, stays)
    assert (told.clear, told.hard) == (1, Fraction(2, 5))
    (other,) = alternative_counts(found)
    # Where o1 is still ahead, nothing is to its right
    assert other.satisfying == other.traces > 0


THREES = compile_rulebook(
    parse_rulebook(
        """
        rulebook threes
        use road
        hard rule amid (u: vehicle, v: vehicle, w: vehicle) {
          require always not (beside(u) and behind(v) and (oncoming(w) or in_front_of(w)))
        }
        """
    )
)


@given(beside_a_queue(), st.data())
@settings(max_examples=settings().max_examples // 4)
def test_of_many_choices_those_that_may_be_lost_are_enough(scenario, data):
    graph = navigation_graph(scenario, partition="fine")
    found = evaluate(graph, THREES)
    assume(found.traces)
    path = data.draw(st.sampled_from(list(islice(paths(graph.trace_graph()), 100))))
    maneuver = Maneuver(path, 0.0, None)
    told = []
    for many in (0, bindings.MANY):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(bindings, "MANY", many)
            told.append(rule_probabilities(found, maneuver))
    assert told[0] == told[1]
