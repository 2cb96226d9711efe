"""All calls of Spot; the only package that imports it.

Spot may use unbounded time or memory, or end its process, on a formula whose automaton explodes. So
this package is loaded only in a separate process, see ``compiler_worker``. The README beside this
file describes the modules.
"""

from rulec.automata.compiler_jobs import CheckError as CheckError
from rulec.automata.spot_bridge.spot_automata import VERSION as VERSION
from rulec.automata.spot_bridge.spot_automata import explore as explore
from rulec.automata.spot_bridge.spot_automata import in_hoa as in_hoa
from rulec.automata.spot_bridge.spot_compiler import COMPILER as COMPILER
from rulec.automata.spot_bridge.spot_formulas import projected as projected
from rulec.automata.spot_bridge.translation import Translation as Translation
from rulec.automata.spot_bridge.translation import translate as translate
