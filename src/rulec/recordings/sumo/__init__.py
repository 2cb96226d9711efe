"""SUMO's floating-car data with their net, read as a recording, without SUMO."""
