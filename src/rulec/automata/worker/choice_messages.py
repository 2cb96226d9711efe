"""Message about an unknown compiler."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NO_COMPILER = Code(
    "R0416",
    title="there is no such compiler",
    why="The variable `RULEC_COMPILER` says which compiler makes automata: `spot`, or `diagrams` "
    "for rulec's own. Unset, it is Spot where that is installed. Their tables are the same.",
    kind="circumstance",
)
