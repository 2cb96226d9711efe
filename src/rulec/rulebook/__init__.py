"""Rulebooks as meant: names resolved, types checked, overlays applied; see README.md."""
