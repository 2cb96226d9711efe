"""All calls of Spot; the only package that imports it.

Spot may use unbounded time or memory, or end its process, on a formula whose automaton explodes. So
this package is loaded only in a separate process, see ``compiler_worker``. The README beside this
file describes the modules.
"""

from rulec.automata.compiler_jobs import CheckError
from rulec.automata.spot_bridge.spot_automata import VERSION, explore, in_hoa
from rulec.automata.spot_bridge.spot_compiler import COMPILER
from rulec.automata.spot_bridge.spot_formulas import projected
from rulec.automata.spot_bridge.translation import Translation, translate

__all__ = [
    "COMPILER",
    "VERSION",
    "CheckError",
    "Translation",
    "explore",
    "in_hoa",
    "projected",
    "translate",
]
