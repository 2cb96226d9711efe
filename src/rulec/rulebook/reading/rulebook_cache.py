"""The cache of resolved rulebooks, under a digest of all that they come from."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.cache.kept_bytes import KeptBytes
from rulec.cache.stored_objects import KeptObjects, ObjectCodec, ObjectKind, kinds_of_fields
from rulec.diagnostics import Source, Span
from rulec.files.read_files import decoded
from rulec.logic import formula as ltl
from rulec.rulebook import rulebook_model as model
from rulec.rulebook.files.search_path import Dependency
from rulec.rulebook.reading.reading_cache import Basis, BookQuestion, recalled, remember_findings
from rulec.vocabulary import Enumeration, ObjectType, Quantity, Signal, Vocabulary
from rulec.vocabulary.vocabulary_model import Meaning

MOST_BOOKS = 200
"""How many rulebooks are kept; the longest unused ones are removed first."""

RULE_KINDS: dict[type, ObjectKind] = {
    ltl.UnaryOperator: ObjectKind(lambda item: (item.value,), ltl.UnaryOperator),
    ltl.BinaryOperator: ObjectKind(lambda item: (item.value,), ltl.BinaryOperator),
    Source: ObjectKind(lambda source: (source.name, source.text), Source),
    **kinds_of_fields(
        (
            *(ltl.Calculated, ltl.NumberSum, ltl.Operation, Meaning),
            *(ltl.Atom, ltl.QuantityTerm, ltl.Count, ltl.Comparison, ltl.Same, ltl.Constant),
            *(ltl.Unary, ltl.Binary, ltl.Bound, Span),
            *(model.Variable, model.Exemption, model.RuleParts, model.SourceFile, model.Rule),
            *(model.Example, model.Axiom, model.Remark, model.Topic, model.Provision),
            *(ObjectType, Enumeration, Signal, Quantity, Vocabulary, model.Rulebook),
        )
    ),
}

_BOOKS = KeptObjects(KeptBytes("book", MOST_BOOKS), ObjectCodec(RULE_KINDS))


def recalled_rulebook(question: BookQuestion) -> model.Loaded | None:
    """The cached rulebook of a source; None if it is unknown."""
    reading, texts = recalled(question)
    if reading is None or any(finding.severity == "error" for finding in reading.findings):
        return None
    sources = {name: decoded(name, data) for name, data in texts.items()}
    rulebook = _BOOKS.recall(_key(question, reading.basis), list(sources.values()))
    if not isinstance(rulebook, model.Rulebook):
        return None
    return model.Loaded(rulebook, reading.findings, sources)


def remember_rulebook(
    question: BookQuestion, loaded: model.Loaded, dependencies: Sequence[Dependency]
) -> None:
    """Cache a rulebook and its warnings, if possible."""
    as_of = loaded.rulebook.as_of
    basis = remember_findings(question, loaded.warnings, dependencies, as_of).basis
    names = dict.fromkeys([question.name, *(dependency.path for dependency in dependencies)])
    sources = [loaded.sources.get(name) for name in names]
    _BOOKS.keep({_key(question, basis): loaded.rulebook}, sources)


def _key(question: BookQuestion, basis: Basis) -> str:
    made_from = basis.stamp, basis.day, *map(repr, basis.dependencies)
    return _BOOKS.files.key(*question.place(), *made_from)
