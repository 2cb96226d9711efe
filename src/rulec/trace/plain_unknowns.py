"""Traces reduced to the unknown values that files can hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from rulec.trace.trace_model import Trace
from rulec.vocabulary.partial_values import UNKNOWN, OneOf


def with_plain_unknowns(trace: Trace) -> Trace:
    """The trace with UNKNOWN for values known to be one of several, which files cannot hold."""
    states = [_plain(state) for state in trace.states]
    same = all(new is old for new, old in zip(states, trace.states, strict=True))
    return trace if same else replace(trace, states=tuple(states))


def _plain(state: Any) -> Any:
    if isinstance(state, OneOf):
        return UNKNOWN
    if not isinstance(state, Mapping):
        return state
    plain = {name: _plain(value) for name, value in state.items()}
    return state if all(plain[name] is state[name] for name in state) else plain
