"""A file in its one canonical form, with its comments.

    text -> scanner, comments: tokens and what stands between them
         -> split_file, grammar: what the parser sees, piece by piece
         -> parentheses, spelling, pieces: documents, which know where lines may end
         -> document: lines -> columns, arrangement: one below the other

Nothing is given out before ``safety`` has compared it with what it was made from.
"""

from rulec.syntax.formatting.safe_format import FormattingError, format_source

__all__ = ["FormattingError", "format_source"]
