"""Recorded drives as traces over a rulebook's vocabulary, and their verdicts."""
