"""Messages about syntax errors, one for each mistake.

``mismatch`` speaks where a piece cannot be parsed, ``advice`` guesses what was meant, ``structure``
speaks about braces.
"""
