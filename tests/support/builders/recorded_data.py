"""Where recordings and maps of others are, if they are at hand; they are not part of this project.

``RULEC_RECORDINGS`` names the folder of CommonRoad's recordings; the other formats' folders are
beside it. Without it, they are looked for in a folder beside the checkout.
"""

import os
from pathlib import Path

_BESIDE = Path(__file__).resolve().parents[4] / "shared/data/commonroad"

RECORDINGS = Path(os.environ.get("RULEC_RECORDINGS", _BESIDE))
"""CommonRoad's recordings."""

DATA = RECORDINGS.parent
"""A folder for each format, named after it."""
