"""Rulebooks with resolved names, checked types and applied overlays; see README.md."""
