"""Rule R1 on traces, by reelay. A job is a list of traces, each a list of valuations.

reelay knows the past alone, so the rule is in the past tense. A monitor cannot begin anew; one for
each trace is made before the time counts.
"""

import json
import sys

import reelay
from serving import serve

PATTERN = "historically({c} or not({f} and pre({r} since {b})))"

traces = json.loads(sys.stdin.readline())


def monitors():
    return ([reelay.discrete_timed_monitor(pattern=PATTERN, condense=False) for _ in traces],)


def judged(monitor, trace):
    for letter in trace:
        verdict = monitor.update(letter)
    return verdict["value"]


serve(lambda made: list(map(judged, made, traces)), monitors)
