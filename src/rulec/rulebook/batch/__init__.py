"""Many files checked or formatted at once, and the cache of checks."""
