"""CommonRoad scenarios: from a file's map and recorded traffic to a scenario along ego's road.

The way through: ``safe_xml`` looks at the file before anything else does -> ``reading`` and
``moving``, which know commonroad-io: the ``recording``, as the file has it -> ``ego``, by a
``choice``: whose maneuvers -> ``route``: the lanelets that it follows -> ``reference_line``: places
along and across them -> ``lanes`` side by side, made straight -> ``traffic``, with the words of
``kinds``, and ``crosswalks``: who and what is where -> ``congestion``, ``signs``: what signals can
be told -> ``convert``: the scenario.
"""
