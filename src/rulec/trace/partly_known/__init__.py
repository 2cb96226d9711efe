"""Values that are partly known, operators of time on them, and the evaluation of formulas."""
