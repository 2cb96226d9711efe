"""The decorator of data classes that commands import when they start."""

from rulec.lazy_dataclass.late_methods import dataclass

__all__ = ["dataclass"]
