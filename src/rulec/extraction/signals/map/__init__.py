"""Signals of places on the map: roads, junctions, crossings."""
