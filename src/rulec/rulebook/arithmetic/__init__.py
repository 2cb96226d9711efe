"""Numbers of expressions: sums of terms in cases, and how large they may become."""
