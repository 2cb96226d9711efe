"""Tracks and lanes as tables, CSV or Parquet, and the data sets that are written so."""
