"""Runs over all drives of a fleet, unit of work by unit of work, into a folder of findings."""
