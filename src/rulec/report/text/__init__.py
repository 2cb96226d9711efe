"""Text shared by all reports: the terminal, Markdown, lists, formulas in words."""
