"""Pictures: marks laid out by pure functions, then written as files.

The formats are SVG, PNG and HTML pages.
"""
