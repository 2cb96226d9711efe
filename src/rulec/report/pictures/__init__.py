"""Pictures as pure layouts of marks, written as SVG, PNG or HTML."""
