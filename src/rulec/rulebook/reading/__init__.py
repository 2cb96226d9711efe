"""Rulebooks as they are read, from the cache where nothing has changed."""
