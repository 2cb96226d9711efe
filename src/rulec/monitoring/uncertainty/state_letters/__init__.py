"""The letters that a partly known state may have."""
