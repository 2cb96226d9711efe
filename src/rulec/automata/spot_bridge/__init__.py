"""Everything that is asked of Spot; the only package that imports it.

Spot may use unbounded time or memory, or end its process, on a formula whose automaton explodes.
So this package is only ever loaded in a process of its own, see ``spot_worker``.

``translation`` is the way from a formula to its automaton, ``wording`` says formulas in Spot's
terms, ``progression`` builds automata of formulas with bounds from their ``obligations``,
``registers`` brings in the past, ``projection`` says what facts mean for the propositions of one
formula, ``checks`` compares automata with formulas, ``hoa`` and ``exploring`` turn them into a file
and into what tables are made of.
"""

from rulec.automata.spot_bridge.equivalence_check import CheckError
from rulec.automata.spot_bridge.exploration import explore
from rulec.automata.spot_bridge.hoa import VERSION, in_hoa
from rulec.automata.spot_bridge.projection import projected
from rulec.automata.spot_bridge.translation import Translation, translate

__all__ = ["VERSION", "CheckError", "Translation", "explore", "in_hoa", "projected", "translate"]
