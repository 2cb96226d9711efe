"""Functions of a drive's context that compute their results only once for whatever these are of."""

from __future__ import annotations

from rulec.extraction.kept_results import kept, kept_in

once = kept
"""For a function of a context."""

once_a_recording = kept_in("surroundings.computed")
"""For one of only the recording and its thresholds.

The recording's surroundings keep the result; they belong to one side of traffic and one choice of
thresholds.
"""

once_a_map = kept_in("surroundings.of_map")
"""For one of only the recording's map."""

once_a_road = kept_in("road.computed")
"""For one of only the map and one road."""
