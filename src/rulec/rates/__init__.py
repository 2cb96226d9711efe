"""How often rules are violated: rates with intervals, from the rows of findings."""
