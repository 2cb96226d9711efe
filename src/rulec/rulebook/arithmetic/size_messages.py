"""Messages about formulas, orders and families that are too large."""

from __future__ import annotations

from rulec.diagnostics.code import Code

FORMULA_TOO_LARGE = Code(
    "R0323",
    title="a formula grows too large when definitions, conditions and exceptions are put in",
    why="Each is put in the place where it is used. Definitions that use others twice, conditional "
    "numbers beside each other, and exceptions that hold throughout multiply.",
    bad="rulebook example\nsignal wet, a, b, c, d, e\nhard rule r {\n  require never (wet then "
    "not wet)\n"
    "  unless a throughout unless b throughout unless c throughout\n"
    "  unless d throughout unless e throughout\n}\n",
    good="rulebook example\nsignal wet, a, b, c, d, e\nhard rule r {\n  require never (wet then "
    "not wet)\n"
    "  unless a or b or c or d or e throughout\n}\n",
)
