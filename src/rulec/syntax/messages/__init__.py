"""Messages about syntax errors, one for each mistake.

``mismatch`` speaks where a piece cannot be parsed: ``expectations`` turns what the grammar would
have taken into words, ``advice`` guesses what was meant. ``structure`` speaks about braces.
"""
