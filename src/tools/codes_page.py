"""The page ``docs/codes.md``, generated from the explanations of the messages."""

from __future__ import annotations

from rulec.report.findings import code_registry


def codes_page() -> str:
    """Render all message codes, as ``rulec explain --all`` does in Markdown."""
    return code_registry.as_page() + "\n"
