"""Names of rulebooks, vocabularies and scenarios, with their titles."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rulec.report.findings.code_registry import all_codes
from rulec.report.text.listing import Listed


def listed(kind: str, search_path: Sequence[Path]) -> tuple[Listed, ...]:
    """The rulebooks, vocabularies, scenarios or codes that there are. Raises RulecError."""
    if kind == "scenarios":
        return _scenarios()
    if kind == "codes":
        return tuple(Listed(text, code.title) for text, code in all_codes().items())
    # The parser of rulebooks, 60 ms: not for codes and scenarios.
    from rulec.rulebook.files.catalogue import list_rulebooks, list_vocabularies

    entries = list_rulebooks if kind == "rulebooks" else list_vocabularies
    return tuple(Listed(entry.name, entry.title, str(entry.path)) for entry in entries(search_path))


def _scenarios() -> tuple[Listed, ...]:
    # Scenarios' formats, 30 ms: only for their titles.
    from rulec.resources import scenarios_folder
    from rulec.scenario import available_scenarios, load_scenario

    return tuple(
        Listed(
            name,
            " ".join(load_scenario(name).about.split()),
            str(scenarios_folder() / f"{name}.toml"),
        )
        for name in available_scenarios()
    )
