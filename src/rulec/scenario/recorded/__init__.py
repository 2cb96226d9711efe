"""Recorded traffic on a real road, and the way from there to a scenario along ego's road.

The way through: the ``recording``, as a file has it -> ``ego``, by a ``choice``: whose maneuvers ->
``route``: the lanelets that it follows -> ``reference_line``: places along and across them ->
``lanes`` side by side, made straight -> ``traffic``, with the words of ``kinds``, and
``crosswalks``: who and what is where -> ``congestion``, ``signs``: what signals can be told ->
``convert``: the scenario.
"""
