"""Messages about scoring futures."""

from __future__ import annotations

from rulec.diagnostics.code import Code

BAD_CANDIDATES = Code("R0780")

NO_TRAJECTORY = Code("R0781")
