"""How long it takes to count, to search and to rank without enumerating.

First scenario S2 at 0.5 s with rules R1 to R3, compared with judging its 75,441 maneuvers one by
one; then a hundred transitions; then fifty vehicles on six lanes with every rule of a national
rulebook, and with rules that no maneuver can satisfy. What takes long is done once.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import islice

from figure import Result
from program import run
from timing import Timed, in_turns, once, processor_time

import rulec
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.planning import Maneuvers, evaluate, partition_for
from rulec.planning.product.graph_product import count_paths, explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.product.possible_instances import instances, violations
from rulec.planning.ranking.cheapest import cheapest
from rulec.rulebook.loader import parse_rulebook
from rulec.scenario import ConstantAcceleration, Ego, Obstacle, Road, Scenario
from rulec.trace.trace_model import paths

CROWDED = """rulebook crowded
use road
traffic right
priority space > progress
hard rule apart (v: vehicle) in space { require always not beside(v) }
hard rule no_near_side (v: vehicle) { require always not (behind(v) and next (near_side_of(v))) }
soft rule ahead (v: vehicle) in progress weight 0.5 { require eventually in_front_of(v) }
"""


def measure(rounds: int) -> Iterator[Result]:
    """From small to large."""
    rules = rulec.compile_rulebook("esterle2019")
    yield small(rules, rounds)
    yield hundred(rules, rounds)
    for name in ("de", "gb", "vienna"):
        yield crowd(name, rulec.compile_rulebook(name, step_s=Fraction(1, 4)))
    yield crowd("rules that cannot be kept", rulec.compile_rulebook(parse_rulebook(CROWDED)))


def small(rules: CompiledRulebook, rounds: int) -> Result:
    """Scenario S2, counted and enumerated."""
    found = evaluate(rulec.navigation_graph("s2", step_s=0.5), rules)
    bound = instances(found.paths, rules)
    one_by_one = once(
        in_ms(lambda: sum(not violations(bound, nodes) for nodes in paths(found.paths)))
    )
    tasks = {
        "both counts": lambda: counts(found),
        "the 100 cheapest satisfying": lambda: list(islice(cheapest(found.product), 100)),
        "before: cells read as letters": lambda: instances(found.paths, rules),
        "before: effects on machines": lambda: node_transformers(found.paths, bound),
        "which rule prunes what": found.prunings,
        "classes": found.classes,
    }
    wanted = {"both counts": 0.15, "the 100 cheapest satisfying": 2}
    taken = in_turns({name: in_ms(work) for name, work in tasks.items()}, rounds)
    name = "both counts"
    against = taken[name].against(one_by_one, "one by one", name, "ms", wanted.pop(name))
    return Result(
        "Counting without enumerating",
        f"S2 at 0.5 s with esterle2019: {found.traces:,} maneuvers, {found.satisfying:,} "
        "satisfying",
        [
            against,
            *(
                one.figure(other, "ms", wanted.get(other))
                for other, one in taken.items()
                if other != name
            ),
            one_by_one.figure("every maneuver judged one by one, once", "ms"),
        ],
    )


def hundred(rules: CompiledRulebook, rounds: int) -> Result:
    """The same over a hundred transitions."""
    found = evaluate(rulec.navigation_graph("s2", step_s=0.5, horizon_s=50), rules)
    taken = in_turns(
        {
            "both counts": in_ms(lambda: counts(found)),
            "before: effects on machines": in_ms(
                lambda: node_transformers(found.paths, found.hard.instances)
            ),
        },
        rounds,
    )
    return Result(
        "A hundred transitions",
        f"S2 for 50 s at 0.5 s with esterle2019: a count of {len(str(found.traces))} digits",
        [
            one.figure(name, "ms", 5 if name == "both counts" else None)
            for name, one in taken.items()
        ],
    )


def counts(found: Maneuvers) -> tuple[int, int]:
    """How many maneuvers there are, and how many satisfy."""
    return count_paths(found.paths), explore(found.hard).accepted


def crowd(name: str, rules: CompiledRulebook) -> Result:
    """Everything that can be asked about fifty vehicles."""
    graph = rulec.navigation_graph(fifty_vehicles(), partition=partition_for(rules, None))
    kept: list[Maneuvers] = []
    judging = once(in_ms(lambda: kept.append(evaluate(graph, rules))))
    (found,) = kept
    # What soft rules need besides is worked out when it is first asked for.
    tasks = {
        "soft rules, too": lambda: found._every,
        "the 100 cheapest": lambda: found.cheapest(100),
        "the best": found.best,
        "the 100 best": lambda: found.ranked(100),
        "which rule prunes what": found.prunings,
        "classes": found.classes,
    }
    return Result(
        f"Fifty vehicles: {name}",
        f"six lanes, 4 s at 0.25 s, {len(rules.rules)} rules, {graph.nodes:,} nodes; "
        f"{found.satisfying:,} of {found.traces:,} maneuvers satisfy; measured once",
        [
            judging.figure("judged and counted", "ms"),
            *(once(in_ms(work)).figure(task, "ms") for task, work in tasks.items()),
        ],
    )


def in_ms(work) -> Timed:
    """Milliseconds of processor time."""
    return processor_time(work, 1e6)


def fifty_vehicles() -> Scenario:
    """Six lanes, 75 m from one vehicle to the next, faster ones to the left."""
    lanes = range(6)
    vehicles = [
        Obstacle(
            f"v{number}",
            "vehicle",
            4.5,
            1.8,
            ConstantAcceleration(-180.0 + 75 * row + 12.5 * lane, 3.5 * lane, 8.0 + lane),
        )
        for number in range(50)
        for row, lane in [divmod(number, len(lanes))]
    ]
    road = Road((-200.0, 500.0), tuple(3.5 * lane - 1.75 for lane in (*lanes, len(lanes))))
    return Scenario("crowd", road, Ego(30.0, 7.0), tuple(vehicles), horizon_s=4.0, step_s=0.25)


if __name__ == "__main__":
    run(measure, rounds=30)
