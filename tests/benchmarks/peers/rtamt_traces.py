"""Rule R1 on traces, by rtamt. A job is a list of traces, each a list of valuations.

In the past tense, because in rtamt a `next` at the end of a trace holds, whatever it is of.
"""

import json
import sys

import rtamt
from serving import serve

NAMES = "cbrf"

specification = rtamt.StlDiscreteTimeOfflineSpecification()
for name in (*NAMES, "out"):
    specification.declare_var(name, "float")
specification.spec = (
    "out = historically((c >= 0.5) or not((f >= 0.5) and once[1:1]((r >= 0.5) since (b >= 0.5))))"
)
specification.parse()
columns = [
    {
        "time": list(range(len(trace))),
        **{name: [float(letter[name]) for letter in trace] for name in NAMES},
    }
    for trace in json.loads(sys.stdin.readline())
]
serve(lambda: [specification.evaluate(trace)[-1][1] > 0 for trace in columns])
