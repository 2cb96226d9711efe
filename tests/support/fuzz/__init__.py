"""Hostile inputs for every verb: it answers, or refuses in words of its own."""
