"""What the building of the site puts into pages."""

import sys
from pathlib import Path

import pytest

EXTENSIONS = str(Path(__file__).resolve().parents[2] / "docs" / "extensions")


@pytest.fixture(scope="module")
def built_parts():
    """The extension that fills them."""
    pytest.importorskip("sphinx")
    sys.path.insert(0, EXTENSIONS)
    try:
        import built_parts
    finally:
        sys.path.remove(EXTENSIONS)
    return built_parts
