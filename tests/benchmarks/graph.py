"""How long it takes to count, to search and to rank without enumerating.

    .venv/bin/python tests/benchmarks/graph.py [ROUNDS]

Processor time, the median of so many rounds; what takes long is done once. First scenario S2 at
0.5 s with rules R1 to R3, compared with judging its 75,441 maneuvers one by one; then a hundred
transitions; then fifty vehicles on six lanes with every rule of a national rulebook, and with rules
that no maneuver can satisfy.
"""

from __future__ import annotations

import statistics
import sys
import time
from fractions import Fraction
from itertools import islice

import rulec
from rulec.automata.compiled import CompiledRulebook
from rulec.maneuvers import Maneuvers, judged, partition_for
from rulec.rulebook.loader import parse_rulebook
from rulec.runtime.cheapest import cheapest
from rulec.runtime.effects import effects
from rulec.runtime.instances import instances, violations
from rulec.runtime.product import count_paths, explore
from rulec.scenario import ConstantAcceleration, Ego, Obstacle, Road, Scenario
from rulec.trace.paths import paths

CROWDED = """rulebook crowded
use road
traffic right
priority space > progress
hard rule apart (v: vehicle) in space { require always not beside(v) }
hard rule no_near_side (v: vehicle) { require always not (behind(v) and next (near_side_of(v))) }
soft rule ahead (v: vehicle) in progress weight 0.5 { require eventually in_front_of(v) }
"""


def main(rounds: int) -> None:
    """Print the figures of so many rounds."""
    rules = rulec.compile_rulebook("esterle2019")
    small(rules, rounds)
    print("a hundred transitions")
    found = judged(rulec.navigation_graph("s2", step_s=0.5, horizon_s=50), rules)
    shown("  effects on machines", lambda: effects(found.paths, found.hard.instances), rounds)
    shown("  both counts", lambda: counts(found), rounds)
    for name in ("de", "gb", "vienna"):
        crowd(name, rulec.compile_rulebook(name, step_s=Fraction(1, 4)))
    crowd("rules that cannot be kept", rulec.compile_rulebook(parse_rulebook(CROWDED)))


def small(rules: CompiledRulebook, rounds: int) -> None:
    """Scenario S2, counted and enumerated."""
    found = judged(rulec.navigation_graph("s2", step_s=0.5), rules)
    print(f"S2 at 0.5 s: {found.traces:,} maneuvers, {found.satisfying:,} satisfying")
    bound = instances(found.paths, rules)
    shown("  cells read as letters", lambda: instances(found.paths, rules), rounds)
    shown("  effects on machines", lambda: effects(found.paths, bound), rounds)
    shown("  both counts", lambda: counts(found), rounds)
    shown("  the 100 cheapest", lambda: list(islice(cheapest(found.product), 100)), rounds)
    shown("  which rule prunes what", found.prunings, rounds)
    shown("  classes", found.classes, rounds)
    shown(
        "  every maneuver judged by itself",
        lambda: sum(not violations(bound, nodes) for nodes in paths(found.paths)),
        1,
    )


def counts(found: Maneuvers) -> tuple[int, int]:
    """How many maneuvers there are, and how many satisfy."""
    return count_paths(found.paths), explore(found.hard).accepted


def crowd(name: str, rules: CompiledRulebook) -> None:
    """Everything that can be asked about fifty vehicles."""
    graph = rulec.navigation_graph(fifty_vehicles(), partition=partition_for(rules, None))
    print(f"{name}: {len(rules.rules)} rules, 50 vehicles, {graph.nodes:,} nodes")
    begin = time.process_time()
    found = judged(graph, rules)
    print(f"  judged {(time.process_time() - begin) * 1e3:31,.1f} ms", end=": ")
    print(f"{found.satisfying:,} of {found.traces:,} satisfying")
    # What soft rules need besides is worked out when it is first asked for.
    shown("  soft rules, too", lambda: found._every, 1)
    shown("  the 100 cheapest", lambda: found.cheapest(100), 1)
    shown("  the best", found.best, 1)
    shown("  the 100 best", lambda: found.ranked(100), 1)
    shown("  which rule prunes what", found.prunings, 1)
    shown("  classes", found.classes, 1)


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


def shown(name: str, work, rounds: int) -> None:
    """Print how long a piece of work takes."""
    taken = []
    for _ in range(rounds):
        begin = time.process_time()
        work()
        taken.append(time.process_time() - begin)
    print(f"{name:36}{statistics.median(taken) * 1e3:12,.3f} ms", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 30)
