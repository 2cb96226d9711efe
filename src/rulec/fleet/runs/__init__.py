"""Runs over all drives of a fleet, one unit of work at a time, into a folder of findings."""
