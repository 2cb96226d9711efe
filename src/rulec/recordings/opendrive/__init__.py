"""Reads ASAM OpenDRIVE maps, versions 1.4 to 1.8."""
