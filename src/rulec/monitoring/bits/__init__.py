"""Formulas evaluated straight on bits, many instants of time or many traces in one operation.

It knows nothing of automata, so it is also an independent check on them.
"""

from rulec.monitoring.bits.instant_planes import along
from rulec.monitoring.bits.trace_planes import across

__all__ = ["across", "along"]
