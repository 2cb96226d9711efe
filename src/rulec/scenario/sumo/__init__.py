"""SUMO's floating-car data with their net, to a recording; nothing of SUMO is needed for it.

``fcd`` reads where everybody was -> ``beside`` finds the other files -> ``net`` reads the roads,
``vehicle_types`` sizes and kinds -> ``lanelets``, with the bounds that ``borders`` draws, and
``lights``; ``tracks``, the participants -> ``reading`` makes the recording. ``attributes`` are
those of an element, checked.
"""
