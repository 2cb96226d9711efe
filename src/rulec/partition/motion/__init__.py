"""What ego can drive: reachable cells, and trajectories through them."""
