"""Where verdicts are not right yet, by kind of world and rule.

Everywhere else every violation has to be found, and nobody accused who did nothing. What has been
mended is taken out; nothing is added.
"""

STORED = {}
"""Rules under which somebody is accused falsely, or a violation counts as kept."""

STORED_UNDECIDED = {}
"""Rules under which a true violation is open, or not judged."""

SIMULATED = {}
"""The same of simulated worlds."""

SIMULATED_UNDECIDED = {}
"""The same of simulated worlds."""

LABELS = {}
"""Rule -> how many are accused falsely, and not found, in all of the recordings at hand."""
