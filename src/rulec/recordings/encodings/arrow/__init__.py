"""Tables in Parquet and Feather files."""
