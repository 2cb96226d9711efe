"""Many files checked or formatted at once, and answers that are kept."""
