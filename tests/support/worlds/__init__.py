"""Simulated traffic, what is true of it by the simulator, and verdicts held against that."""
