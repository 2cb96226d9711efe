"""Arrow itself, if it is there."""

from __future__ import annotations

from typing import Any

from rulec.diagnostics import RulecError, SourceLocation
from rulec.trace.trace_messages import PARQUET_UNAVAILABLE


def arrow(file: str) -> tuple[Any, Any]:
    """Import Arrow and its Parquet module.

    Raises RulecError R0706 if it is not installed.
    """
    try:
        import pyarrow  # an extra, and 0.1 s
        from pyarrow import parquet  # an extra, and 0.1 s
    except ImportError:
        message = "Parquet takes the package `pyarrow`, which is not installed"
        raise unavailable(message, file, "`pip install 'rulec[parquet]'`") from None
    return pyarrow, parquet


def unavailable(message: str, file: str, help_text: str) -> RulecError:
    """Parquet cannot be read or written here (R0706)."""
    return PARQUET_UNAVAILABLE.error(SourceLocation(file), message, help=help_text)
