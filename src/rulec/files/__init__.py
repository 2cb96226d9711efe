"""Files: read within limits, written completely or not at all, and what a work tree may not do."""
