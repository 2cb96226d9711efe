"""A compiler without Spot, on decision diagrams, for formulas that prefixes of a word decide.

The README beside this file describes the modules.
"""
