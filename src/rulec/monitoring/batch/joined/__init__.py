"""Traces laid end to end, whatever they were given as."""
