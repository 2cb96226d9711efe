"""Values that are partly known, and what formulas mean on them."""
