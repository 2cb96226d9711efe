"""Pictures of recorded drives: the road from above, moment by moment."""
