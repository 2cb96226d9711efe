"""Files of rulebooks and vocabularies: where they are, and which need which."""
