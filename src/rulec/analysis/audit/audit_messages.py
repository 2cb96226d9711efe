"""Messages about saved audits, and texts of laws."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NOT_AN_AUDIT = Code("R0705")

NO_ARTICLES = Code("R0714")
