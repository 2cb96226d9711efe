"""Pages tried in a real browser: a Chromium, a file server, what goes wrong, links."""
