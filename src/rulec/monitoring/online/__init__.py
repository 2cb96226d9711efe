"""Runtime monitoring: Mealy monitors that process one state at a time."""
