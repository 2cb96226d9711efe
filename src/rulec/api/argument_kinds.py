"""Type checks of the arguments of public functions."""

from __future__ import annotations


def expect(given: object, kind: type, way_out: str) -> None:
    """Raise TypeError, with what to give instead, for what is neither of a kind nor None."""
    if given is not None and not isinstance(given, kind):
        raise TypeError(f"expected {kind.__name__}, not {type(given).__name__}: {way_out}")


ASSUMPTIONS_EXAMPLE = 'rulec.Assumptions(ends="cut")'
REQUEST_EXAMPLE = 'rulec.RequestedDrives(egos=["12"])'
