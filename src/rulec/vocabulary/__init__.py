"""Vocabularies: object types, enumerations, signals and quantities."""

from rulec.vocabulary.vocabulary_model import (
    Declaration,
    Enumeration,
    ObjectType,
    Quantity,
    Signal,
    Vocabulary,
)

__all__ = ["Declaration", "Enumeration", "ObjectType", "Quantity", "Signal", "Vocabulary"]
