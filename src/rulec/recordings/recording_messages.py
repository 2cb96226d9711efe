"""Messages about recordings."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NOT_A_RECORDING = Code("R0610")

NOT_IN_RECORDING = Code("R0612")

OTHER_CHOICE = Code("R0613")

NET_MISSING = Code("R0614")

OTHER_NET = Code("R0615")

NOT_BUILT = Code("R0617")
