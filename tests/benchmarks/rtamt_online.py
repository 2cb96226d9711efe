"""What online.py measures, by rtamt: nanoseconds of processor time for a state, a line a round."""

import random
import sys
import time

import rtamt


def main(rounds, n_states):
    """Print the figures of so many rounds."""
    monitor = rtamt.StlDiscreteTimeOnlineSpecification()
    monitor.declare_var("p", "float")
    monitor.declare_var("q", "float")
    monitor.declare_var("out", "float")
    monitor.spec = "out = historically((p >= 0.5) implies once[0:3](q >= 0.5))"
    monitor.parse()
    chance = random.Random(5)
    states = [(float(chance.random() < 0.3), 1.0) for _ in range(n_states)]
    number = 0
    for _ in range(rounds):
        start = time.process_time_ns()
        for p, q in states:
            monitor.update(number, [("p", p), ("q", q)])
            number += 1
        print((time.process_time_ns() - start) / n_states)


main(int(sys.argv[1]), int(sys.argv[2]))
