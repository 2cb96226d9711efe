"""Small rulebooks, vocabularies, recordings and files, made by hand."""
