"""A cache of the trees of files that were read without mistakes, kept between calls."""
