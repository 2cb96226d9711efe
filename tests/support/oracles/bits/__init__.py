"""Formulas evaluated straight on bits, many instants of time or many traces in one operation.

It knows nothing of automata, so it is also an independent check on them.
"""

from support.oracles.bits.instant_planes import along
from support.oracles.bits.trace_planes import across

__all__ = ["across", "along"]
