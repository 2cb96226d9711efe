"""The content of an OpenDRIVE file as data, before it is turned into a map."""
