"""Text that all reports share: the terminal, Markdown, lists, formulas in words."""
