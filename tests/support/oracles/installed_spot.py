"""Spot and what rulec asks of it, where it is installed; who needs it elsewhere is skipped."""

import pytest

from rulec.automata.alphabet import count_letters, letters_with
from rulec.automata.tables import build_machine, rows_of


class _Missing:
    def __getattr__(self, name):
        pytest.skip("Spot is not installed", allow_module_level=True)

    def __call__(self, *_):
        return self.called


try:
    import spot

    from rulec.automata import spot_bridge
    from rulec.automata.spot_bridge.spot_formulas import SpotFormulas
except ImportError:
    spot = spot_bridge = SpotFormulas = _Missing()

__all__ = ["SpotFormulas", "machine_of", "spot", "spot_bridge"]


def machine_of(translation, reads):
    """The minimal machine of an automaton of Spot's over all letters of these reads."""
    n_letters = count_letters(reads)
    letters = letters_with(reads, translation.names)
    automaton = spot_bridge.explore(translation, letters, n_letters)
    return build_machine(rows_of(automaton, (1 << n_letters) - 1), reads)
