"""Text without the line ends at which it was wrapped."""


def unwrapped(text):
    """A text with each stretch of white space as one space."""
    return " ".join(text.split())
