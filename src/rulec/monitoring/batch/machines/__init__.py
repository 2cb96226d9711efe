"""TODO monitoring/batch/machines."""
