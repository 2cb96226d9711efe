"""Messages about syntax errors, one for each mistake.

``mismatch`` reports pieces that cannot be parsed, ``advice`` guesses what was meant, ``structure``
reports missing or misplaced braces.
"""
