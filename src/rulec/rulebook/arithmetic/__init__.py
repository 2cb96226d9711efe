"""Linear arithmetic of expressions by cases, and limits of its size."""
