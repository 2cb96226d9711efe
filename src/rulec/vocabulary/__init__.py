"""What a rule can speak of: object types, enumerated state, signals, quantities."""

from rulec.vocabulary.vocabulary_model import (
    Declaration,
    Enumeration,
    ObjectType,
    Quantity,
    Signal,
    Vocabulary,
)

__all__ = ["Declaration", "Enumeration", "ObjectType", "Quantity", "Signal", "Vocabulary"]
