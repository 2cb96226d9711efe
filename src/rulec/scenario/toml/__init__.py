"""Scenarios from TOML files, every mistake with its source location."""
