"""Arrow itself, if it is there."""

from __future__ import annotations

from typing import Any

from rulec.diagnostics import Diagnostic, RulecError, SourceLocation


def arrow(file: str) -> tuple[Any, Any]:
    """The library, and its part for Parquet. Raises RulecError R0706 if it is not installed."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        message = "Parquet takes the package `pyarrow`, which is not installed"
        raise unavailable(message, file, "`pip install 'rulec[parquet]'`") from None
    return pyarrow, parquet


def unavailable(message: str, file: str, help_text: str) -> RulecError:
    """Parquet cannot be read or written here (R0706)."""
    return RulecError(Diagnostic("R0706", message, SourceLocation(file), help=help_text))
