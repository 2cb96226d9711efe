"""What is known of the values in a state, for letters and states alike."""
