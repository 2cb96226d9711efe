"""Messages about evaluating navigation graphs."""

from __future__ import annotations

from rulec.diagnostics.code import Code

MOST_WORLDS = 10_000
"""The most worlds that are examined one by one for a rule that counts objects."""

TWO_PARTITIONS = Code("R0405")

UNFITTING_PAST = Code("R0511")

TOO_MANY_MANEUVERS = Code("R0616")
