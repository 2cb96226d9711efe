"""Messages about pictures."""

from __future__ import annotations

from rulec.diagnostics.code import Code

PNG_UNAVAILABLE = Code("R0707")
