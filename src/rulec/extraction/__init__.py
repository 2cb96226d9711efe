"""Recorded drives as traces: what every vehicle of a recording did, in the words of rulebooks.

The way through: ``everyone``: positions and speeds as arrays -> ``whereabouts``, ``ways``: the
lanelets that ego drove -> ``road``, ``placed``: everybody along and across it -> ``nearness``,
``company``: who is there for ego -> ``view``: one drive -> ``ego_words``, ``other_words``,
``map_words``, ``flow``: words, by ``thresholds`` -> ``fitting``: those that a vocabulary has ->
``telling``: the trace -> ``extract``: all drives -> ``judging``. ``mirror`` is for rulebooks of the
other side.
"""
