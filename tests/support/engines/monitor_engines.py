"""Engines that judge a trace state by state."""

import json

from rulec.api.named_monitor import Monitor
from support.engines.engine import each, said
from support.oracles.presence import there
from support.oracles.rulebook_oracle import Said


def watched(save_after):
    """State by state; the monitor is saved and restored after those that are chosen."""

    @each
    def judge_one(rulebook, compiled, trace):
        monitor = Monitor(compiled, trace.step_s)
        for n, state in enumerate(trace.states):
            monitor.step(state, there(trace, n))
            if save_after(n, len(trace.states)):
                snapshot = json.loads(json.dumps(monitor.snapshot()))
                monitor = Monitor.restore(compiled, snapshot)
        return ended(monitor, compiled)

    return judge_one


def ended(monitor, compiled):
    """What is violated if this is the end: for good, or because something is pending."""
    strengths = {rule.name: rule.strength for rule in compiled.rules}
    pending = [
        Said(about["rule"], tuple(one["objects"]), -1, strengths[about["rule"]])
        for about in monitor.snapshot()["rules"]
        for one in about["bindings"]
        if one["verdict"] == "pending"
    ]
    return tuple(sorted([*said(monitor.violations), *pending]))
