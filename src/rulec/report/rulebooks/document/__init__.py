"""A rulebook as a document for lawyers."""
