"""Verdicts, maneuvers and diagnostics as text and JSON: one renderer per file."""
