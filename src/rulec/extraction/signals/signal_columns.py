"""What is said of a drive: columns of values by name, about the world or about objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.extraction.tracks.tracks import Flags

SignalColumn = NDArray[Any]


@dataclass(frozen=True, slots=True)
class SignalColumns:
    """``world``: a value for every state. ``about``: a row of them for everybody there.

    ``unknown``: where nothing can be said of a word of the world. ``only``: of whom a word about
    objects can be said at all.
    """

    world: Mapping[str, SignalColumn] = field(default_factory=dict)
    about: Mapping[str, SignalColumn] = field(default_factory=dict)
    unknown: Mapping[str, Flags] = field(default_factory=dict)
    only: Mapping[str, Flags] = field(default_factory=dict)

    def __or__(self, other: SignalColumns) -> SignalColumns:
        return SignalColumns(
            {**self.world, **other.world},
            {**self.about, **other.about},
            {**self.unknown, **other.unknown},
            {**self.only, **other.only},
        )


def named_values(codes: SignalColumn, names: Sequence[str]) -> SignalColumn:
    """The names that whole numbers stand for."""
    return np.array(names)[codes]


def rounded(values: SignalColumn) -> SignalColumn:
    """Numbers as they are written: to a hundredth, as places are no better known."""
    return np.round(values, 2) + 0.0
