"""Message about an unknown compiler."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NO_COMPILER = Code("R0416")
