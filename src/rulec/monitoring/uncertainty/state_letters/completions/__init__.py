"""The joint values that unknown values may have."""
