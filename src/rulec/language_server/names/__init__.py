"""Definitions and references of names, in a document and in the workspace."""
