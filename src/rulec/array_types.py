"""Types of arrays that many modules have in common."""

from numpy import bool_, float64, intp
from numpy.typing import NDArray

Flags = NDArray[bool_]

Floats = NDArray[float64]

Indices = NDArray[intp]
