"""Product of trace graphs and monitors."""
