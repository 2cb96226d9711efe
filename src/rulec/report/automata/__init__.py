"""Automata of rules as text, Graphviz sources and pictures."""
