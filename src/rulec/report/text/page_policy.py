"""What a page may load: nothing but the styles and scripts within it."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable
from hashlib import sha256


def policy(styles: Iterable[str], scripts: Iterable[str]) -> str:
    """The content policy of a page that loads nothing, for the texts of its own elements."""
    own_styles, own_scripts = (
        " ".join(map(_hash, texts)) or "'none'" for texts in (styles, scripts)
    )
    return f"default-src 'none'; style-src {own_styles}; script-src {own_scripts}"


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
