"""A compiler of its own, on decision diagrams, for whatever prefixes of a word decide.

The modules are described in the README beside this.
"""
