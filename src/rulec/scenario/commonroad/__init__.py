"""CommonRoad's files, read safely: from XML through commonroad-io to a recording.

``safe_xml`` looks at the file before anything else does -> ``reading`` and ``moving``, which know
commonroad-io, make the recording.
"""
