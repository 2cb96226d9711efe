"""A release: all that it has, built and tried as a stranger would."""
