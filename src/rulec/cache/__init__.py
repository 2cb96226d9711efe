"""Caches between calls: their folder, its owner, values in files."""
