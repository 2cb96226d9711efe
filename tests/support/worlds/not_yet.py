"""Where verdicts are not right yet, by kind of world and rule.

Everywhere else every violation has to be found, and nobody accused who did nothing. What has been
mended is taken out; nothing is added.
"""

STORED = {"right_before_left": {"junction_priority"}}
"""Who drives into the side of one who was there first counts as having let it pass."""

STORED_UNDECIDED = {}
"""Rules under which a true violation is open, or not judged."""

SIMULATED = {}
"""The same of simulated worlds."""

SIMULATED_UNDECIDED = {"motorway": {"near_side_passing"}}
"""Where the map begins nobody knows whether there are queues."""

LABELS = {}
"""Rule -> how many are accused falsely, and not found, in all of the recordings at hand."""
