"""The choice of drives, thresholds, and participants that count for ego."""
