"""CommonRoad's files, read safely: from XML through commonroad-io to a recording.

``form`` looks at the file before the library gets it -> ``reading`` and ``moving``, which know
commonroad-io, make the recording.
"""
