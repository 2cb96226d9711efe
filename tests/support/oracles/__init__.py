"""Meanings written down a second time from the documentation; no code of rulec is in them."""
