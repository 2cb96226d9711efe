"""Rates of violations as text, Markdown, CSV, JSON and a picture."""
