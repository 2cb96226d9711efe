"""Messages about navigation graphs and their paths."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NO_START_CELL = Code("R0607")

UNKNOWN_PARTITION = Code("R0608")

NOT_A_PATH = Code("R0609")
