"""The JSON schemas in docs/schemas, generated from the types that rulec writes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from inspect import cleandoc
from typing import Any

import msgspec

from rulec.automata.bundle.bundle_schema import BundleFile
from rulec.fleet.finding_columns import FindingRowLine
from rulec.monitoring.online.snapshot import SavedMonitor
from rulec.report.findings.diagnostics_json import CodeData, FindingData
from rulec.report.findings.verdict_finding import FindingLine
from rulec.report.maneuvers.envelope_table import EnvelopeLine
from rulec.report.maneuvers.maneuver_document import ManeuversDocument
from rulec.report.moments.moment_rows import MomentLine
from rulec.report.rates.rates_table import RatesDocument
from rulec.report.recordings.format_listing import FormatsDocument
from rulec.report.rulebooks.audit_report import AuditDocument
from rulec.report.rulebooks.comparison.diff_formats import DiffDocument, TraceData
from rulec.report.rulebooks.comparison.matrix_report import MatrixDocument
from rulec.report.rulebooks.lineage_tree import ForestDocument, LineageDocument
from rulec.report.rulebooks.proof_report import ProofsDocument
from rulec.report.rulebooks.rule_list import RuleListDocument
from rulec.report.rulebooks.rule_page import RulesDocument
from rulec.report.rulebooks.word_texts import WordData
from rulec.report.tests.example_formats import ExamplesRun
from rulec.report.text.listing import ListingDocument
from rulec.report.verdicts.recording_json import NotDriven, RecordedNotJudged, RecordedVerdict
from rulec.report.verdicts.running_verdicts import StateRefused, StateVerdict
from rulec.report.verdicts.verdict_json import TraceNotJudged, TraceVerdict

SCHEMAS: Mapping[str, tuple[Any, ...]] = {
    "audit": (AuditDocument,),
    "codes": (list[CodeData],),
    "compiled": (BundleFile,),
    "diff": (DiffDocument,),
    "envelope": (EnvelopeLine,),
    "exposure": (FindingRowLine,),
    "finding": (FindingLine,),
    "findings": (list[FindingData],),
    "formats": (FormatsDocument,),
    "list": (ListingDocument,),
    "maneuvers": (ManeuversDocument,),
    "matrix": (MatrixDocument,),
    "moment": (MomentLine,),
    "monitor": (SavedMonitor,),
    "proofs": (ProofsDocument,),
    "rates": (RatesDocument,),
    "rules": (RuleListDocument,),
    "show": (RulesDocument,),
    "state": (StateVerdict, StateRefused),
    "test": (ExamplesRun,),
    "trace": (TraceData,),
    "tree": (LineageDocument, ForestDocument),
    "verdict": (
        TraceVerdict,
        TraceNotJudged,
        RecordedVerdict,
        RecordedNotJudged,
        NotDriven,
    ),
    "words": (list[WordData],),
}
"""Name -> the types of an output, or of a line of it; several types differ in their fields."""


def schema_text(name: str) -> str:
    """Generate a schema of JSON Schema 2020-12."""
    schemas, definitions = msgspec.json.schema_components(
        SCHEMAS[name], ref_template="#/$defs/{name}"
    )
    outputs = list(schemas)
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"rulec: {name}",
        **(outputs[0] if len(outputs) == 1 else {"anyOf": outputs}),
        "$defs": {key: _required_version(value) for key, value in sorted(definitions.items())},
    }
    return json.dumps(_without_indents(schema), ensure_ascii=False, indent=2) + "\n"


def _without_indents(part: Any) -> Any:
    """Strip indents from descriptions: docstrings keep them before Python 3.13."""
    match part:
        case dict():
            return {
                key: cleandoc(value)
                if key == "description" and isinstance(value, str)
                else _without_indents(value)
                for key, value in part.items()
            }
        case list():
            return [_without_indents(item) for item in part]
    return part


def _required_version(definition: dict[str, Any]) -> dict[str, Any]:
    """Mark version and digest as required: despite their defaults they are always written."""
    if "version" not in definition.get("properties", {}):
        return definition
    written = [key for key in ("sha256", "version") if key in definition["properties"]]
    required = [key for key in definition.get("required", []) if key not in written]
    return {**definition, "required": [*written, *required]}
