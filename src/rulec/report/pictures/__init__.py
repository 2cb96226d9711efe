"""Pictures: laid out as marks by pure functions, then written as SVG, PNG or a page."""
