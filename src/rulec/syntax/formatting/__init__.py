"""Formats a file into its canonical form, keeping its comments.

    text -> scanner, comments: tokens and what stands between them
         -> split_file, grammar: parse nodes, piece by piece
         -> parentheses, spelling, pieces: documents with possible line breaks
         -> document: lines -> columns, arrangement: the whole file

The result is returned only after ``safety`` has compared it with the original.
"""

from rulec.syntax.formatting.safe_format import FormattingError, format_bytes, format_source

__all__ = ["FormattingError", "format_bytes", "format_source"]
