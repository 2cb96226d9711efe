"""What unknown values may be together."""
