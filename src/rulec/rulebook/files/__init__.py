"""The files of rulebooks and vocabularies: where they are, and how they depend on each other."""
