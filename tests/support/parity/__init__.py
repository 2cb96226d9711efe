"""One made-up world in many formats, so that verdicts on it can be held against each other."""
