"""Messages about formulas, orders and families that are too large."""

from __future__ import annotations

from rulec.diagnostics.code import Code

FORMULA_TOO_LARGE = Code("R0323")

TOO_LONG = Code("R0327")
