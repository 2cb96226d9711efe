"""Files of traces: JSON Lines, CSV, Parquet."""
