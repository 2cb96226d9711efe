"""Help for who is writing: what fits at the cursor, and what mends a mistake."""
