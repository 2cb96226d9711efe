"""Formulas evaluated straight on bits, many instants of time or many traces in one operation.

It knows nothing of automata, so it is also an independent check on them.
"""

from rulec.runtime.bits.across import across
from rulec.runtime.bits.along import along

__all__ = ["across", "along"]
