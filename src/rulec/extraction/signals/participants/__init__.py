"""Signals of the other participants, one by one."""
