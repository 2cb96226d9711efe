"""A response on two signals, state by state, by rtamt: a job's states, then the same again."""

import json
import sys
from itertools import count

import rtamt
from serving import serve

states = [
    [(name, float(value)) for name, value in state.items()]
    for state in json.loads(sys.stdin.readline())
]
numbers = count()
specification = rtamt.StlDiscreteTimeOnlineSpecification()
for name in ("p", "q", "out"):
    specification.declare_var(name, "float")
specification.spec = "out = historically((p >= 0.5) implies once[0:3](q >= 0.5))"
specification.parse()


def work():
    for state in states:
        robustness = specification.update(next(numbers), state)
    return bool(robustness > 0)


serve(work)
