"""Drivability for ego: reachable cells, and trajectories through them."""
