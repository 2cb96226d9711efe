"""CommonRoad scenarios: from a file's map and recorded traffic to a scenario along ego's road.

The way through: ``safe_xml`` looks at the file before anything else does -> ``reading``, the only
file that knows commonroad-io: the ``recording``, as the file has it -> ``route``: the lanelets that
ego follows -> ``reference_line``: places along and across them -> ``lanes``: the lanes side by side,
made straight -> ``traffic``: who is where when -> ``congestion``, ``signs``: what signals can be
told -> ``convert``: the scenario.
"""
