"""An OpenDRIVE file as data, before it is a map."""
