"""Spot and what rulec asks of it, where it is installed; who needs it elsewhere is skipped."""

import pytest


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

__all__ = ["SpotFormulas", "spot", "spot_bridge"]
