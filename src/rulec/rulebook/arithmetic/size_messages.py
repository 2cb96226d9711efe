"""Messages about formulas, orders and families that are too large."""

from __future__ import annotations

from rulec.diagnostics.code import Code

FORMULA_TOO_LARGE = Code(
    "R0323",
    title="a formula becomes too large when definitions, conditions and exceptions are expanded",
    why="Each of them is expanded where it is used. Definitions that use others twice, several "
    "conditional numbers, and exceptions that hold throughout multiply the size.",
    bad="rulebook example\nsignal wet, a, b, c, d, e\nhard rule r {\n  require never (wet then "
    "not wet)\n"
    "  unless a throughout unless b throughout unless c throughout\n"
    "  unless d throughout unless e throughout\n}\n",
    good="rulebook example\nsignal wet, a, b, c, d, e\nhard rule r {\n  require never (wet then "
    "not wet)\n"
    "  unless a or b or c or d or e throughout\n}\n",
)
