"""Reads CommonRoad scenarios as recordings, without CommonRoad's library."""
