"""Tables read with Arrow, an optional dependency."""
