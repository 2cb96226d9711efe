"""Poses in three dimensions, for transforms from ego's frame to the city's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import int64, intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.encodings.arrow.arrow_tables import ArrowTable


@dataclass(frozen=True, eq=False, slots=True)
class CityPoses:
    """Rotations (3 x 3 matrices) and translations (m), one row each."""

    rotations: Floats
    translations: Floats

    @property
    def headings(self) -> Floats:
        """The directions (rad) of the x axes in the plane."""
        headings: Floats = np.arctan2(self.rotations[:, 1, 0], self.rotations[:, 0, 0])
        return headings

    def taken(self, rows: NDArray[intp]) -> CityPoses:
        """The poses in the given rows."""
        return CityPoses(self.rotations[rows], self.translations[rows])

    def after(self, inner: CityPoses) -> CityPoses:
        """Poses in these frames, converted to these frames' outer frame, row by row."""
        moved = np.einsum("nij,nj->ni", self.rotations, inner.translations) + self.translations
        return CityPoses(np.einsum("nij,njk->nik", self.rotations, inner.rotations), moved)


def poses_in(
    table: ArrowTable, rows: NDArray[int64], places: Floats, quaternions: Floats
) -> CityPoses:
    """The poses in rows of a table. Raises RulecError R0610 for a quaternion of 0."""
    flat = np.abs(quaternions).max(axis=1, initial=0.0) < 1e-6
    if flat.any():
        raise table.refused(int(rows[np.argmax(flat)]), "its quaternion is 0")
    return CityPoses(rotations(quaternions), places)


def rotations(quaternions: Floats) -> Floats:
    """The rotation matrices of quaternions (w, x, y, z) of any length except 0."""
    w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1)[:, None]).T
    rows = (
        (x * x - y * y - z * z + w * w, 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), -x * x + y * y - z * z + w * w, 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), -x * x - y * y + z * z + w * w),
    )
    matrices: Floats = np.stack([np.stack(row, axis=-1) for row in rows], axis=1)
    return matrices
