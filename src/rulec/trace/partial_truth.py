"""Truth that is partly known, in many states at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rulec.array_types import Flags


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Where something is ``sure`` and where it is ``possible``, in masks that broadcast.

    What is sure is also possible. The operators are those of Kleene's strong three-valued logic.
    """

    sure: Flags
    possible: Flags

    @staticmethod
    def known(values: Flags) -> Truth:
        """Truth that is known everywhere."""
        return Truth(values, values)

    @property
    def is_known(self) -> bool:
        """Whether it is known everywhere by its making: both halves are one mask."""
        return self.sure is self.possible

    def __invert__(self) -> Truth:
        return Truth.known(~self.sure) if self.is_known else Truth(~self.possible, ~self.sure)

    def __and__(self, other: Truth) -> Truth:
        if self.is_known and other.is_known:
            return Truth.known(self.sure & other.sure)
        return Truth(self.sure & other.sure, self.possible & other.possible)

    def __or__(self, other: Truth) -> Truth:
        if self.is_known and other.is_known:
            return Truth.known(self.sure | other.sure)
        return Truth(self.sure | other.sure, self.possible | other.possible)

    def same_as(self, other: Truth) -> Truth:
        """Both or neither."""
        return self & other | ~self & ~other

    def unknown_at(self, unknown: Flags) -> Truth:
        """The same truth, but unknown where a mask says so."""
        return Truth(self.sure & ~unknown, self.possible | unknown)

    @property
    def unknown(self) -> Flags:
        """Where it is possible, but not sure."""
        return self.possible & ~self.sure

    def __getitem__(self, chosen: Any) -> Truth:
        return Truth(self.sure[chosen], self.possible[chosen])

    def spread(self, shape: tuple[int, ...]) -> Truth:
        """The same truth, broadcast to a shape."""
        return Truth(np.broadcast_to(self.sure, shape), np.broadcast_to(self.possible, shape))


TRUE, FALSE = Truth.known(np.array(True)), Truth.known(np.array(False))
UNKNOWN = Truth(FALSE.sure, TRUE.sure)
