"""Messages about scenarios."""

from __future__ import annotations

from rulec.diagnostics.code import Code

UNKNOWN_SCENARIO = Code("R0601")

NOT_A_SCENARIO = Code("R0602")

MISSING_OR_UNKNOWN_FIELD = Code("R0603")

UNFITTING_FIELD = Code("R0604")

INCONSISTENT_SCENARIO = Code("R0605")

UNFITTING_BOUNDS = Code("R0770")

UNFITTING_HORIZON = Code("R0606")
