"""ASAM OSI traces, read as recordings."""
