"""Messages about limits on the cost of a question."""

from __future__ import annotations

from rulec.diagnostics.code import Code

OVER_LIMIT = Code("R0718")

NO_LIMIT = Code("R0719")
