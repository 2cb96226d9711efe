"""Message about an unknown compiler."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NO_COMPILER = Code(
    "R0416",
    title="there is no such compiler",
    why="The variable `RULEC_COMPILER` selects the compiler for automata: `spot`, or `diagrams` "
    "for rulec's own. By default it is Spot if installed. Both produce the same tables.",
    kind="circumstance",
)
