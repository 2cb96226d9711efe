"""Small rulebooks with traces and their verdicts, thought out by hand."""
