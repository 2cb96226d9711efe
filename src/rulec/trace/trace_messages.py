"""Messages about traces and the files that hold them."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NOT_A_TRACE = Code("R0501")

UNKNOWN_OBJECT = Code("R0505")

NO_STATES = Code("R0506")

NOT_A_TABLE = Code("R0509")

SAME_ID = Code("R0512")

PARQUET_UNAVAILABLE = Code("R0706")
