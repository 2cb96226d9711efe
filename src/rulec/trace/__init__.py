"""Traces, their files, and graphs whose paths are traces."""

from rulec.trace.trace_model import State, Trace, TraceGraph, Value

__all__ = ["State", "Trace", "TraceGraph", "Value"]
