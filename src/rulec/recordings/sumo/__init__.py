"""Reads SUMO's floating-car data and their net as a recording, without SUMO."""
