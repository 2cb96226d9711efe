"""What is shown between the lines: hints within them, lenses above rules."""
