"""Everything that is asked of Spot; the only package that imports it.

Spot may use unbounded time or memory, or end its process, on a formula whose automaton explodes.
So this package is only ever loaded in a process of its own, see ``spot_worker``.

``translation`` is the way from a formula to its automaton, ``spot_formulas`` translates formulas to
Spot's, ``progression`` builds automata of formulas with bounds from their ``obligations``,
``registers`` brings in the past, ``projection`` says what axioms mean for the propositions of one
formula, ``equivalence_check`` compares automata with formulas, ``hoa`` and ``exploration`` turn
them into a file and into tables.
"""

from rulec.automata.spot_bridge.equivalence_check import CheckError
from rulec.automata.spot_bridge.exploration import explore
from rulec.automata.spot_bridge.hoa import VERSION, in_hoa
from rulec.automata.spot_bridge.projection import projected
from rulec.automata.spot_bridge.translation import Translation, translate

__all__ = ["VERSION", "CheckError", "Translation", "explore", "in_hoa", "projected", "translate"]
