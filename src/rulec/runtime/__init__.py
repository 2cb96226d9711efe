"""Compiled rules run: on traces, and on graphs of traces.

Needs a compiled rulebook and nothing that made it: neither Spot nor Lark, Shapely or NetworkX.
"""
