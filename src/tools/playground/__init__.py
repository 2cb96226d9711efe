"""The playground: a page that runs rulec in a browser, and the program that builds it."""
