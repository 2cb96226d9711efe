"""The playground: a page that runs rulec in a browser, and what puts it together."""
