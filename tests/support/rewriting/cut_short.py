"""A part of a recording's time, and what verdicts on it may not say of the whole."""

from dataclasses import replace

import numpy as np

from rulec.recordings.mending.rows_of_states import with_states_at


def steps_of(recording):
    """The first and the last time step of somebody."""
    steps = [step for body in recording.participants for step in body.outlines]
    return min(steps), max(steps)


def cut(recording, first, last):
    """What whoever recorded from one step to another would have."""
    bodies = []
    for body in recording.participants:
        there = np.array([step for step in body.states if first <= step <= last])
        if len(there):
            lamps = {step: lit for step, lit in body.lamps.items() if first <= step <= last}
            bodies.append(replace(with_states_at(body, there), lamps=lamps))
    return replace(recording, participants=tuple(bodies))


def contradictions(whole, part, until_s=None):
    """What ``judged`` says of a part that the whole denies: (ego, rule, what each says).

    Who violates a rule in a part violates it in the whole. Until a time (s), if the part begins
    with the whole, what is violated in the whole is violated or open in the part.
    """
    then, now = _by_ego(whole), _by_ego(part)
    found = [
        (*key, then.get(key, "kept"), said)
        for key, said in now.items()
        if isinstance(said, frozenset) and not isinstance(then.get(key), frozenset)
    ]
    if until_s is not None:
        egos = {ego for ego, rule in part if not rule and not isinstance(part[ego, rule], str)}
        found += [
            (*key, said, "kept")
            for key, said in then.items()
            if isinstance(said, frozenset) and key[0] in egos and key not in now
            if min(at for at, _ in said) <= until_s
        ]
    return found


def _by_ego(found):
    return {key: said for key, said in found.items() if key[1]}
