"""A response on two signals, state by state, by reelay: a job's states, then the same again."""

import json
import sys

import reelay
from serving import serve

PATTERN = "historically(not{p} or once[0:3]{q})"

states = json.loads(sys.stdin.readline())
monitor = reelay.discrete_timed_monitor(pattern=PATTERN, condense=False)


def work():
    for state in states:
        verdict = monitor.update(state)
    return verdict["value"]


serve(work)
