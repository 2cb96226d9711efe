"""The registry of diagnostic codes: what each kind of message is about, in one line.

The hundreds name the stage that speaks: 1 syntax, 2 names, 3 types and meaning, 4 compiling,
5 traces, 6 scenarios and graphs, 7 files.
"""

from __future__ import annotations

CODES: dict[str, str] = {
    # 4: compiling
    "R0401": "the automaton of a rule would be too large",
    "R0402": "the compiled automaton failed its check against the formula",
    "R0403": "Spot is not installed",
    "R0404": "a compiled rulebook is damaged or of another version",
    "R0405": "a rulebook reads relations of two partitions",
    # 5: traces
    "R0501": "a line is not a trace in JSON",
    "R0502": "a state uses a name that the vocabulary does not know",
    "R0503": "a state's value does not fit its declaration",
    "R0504": "a state lacks a value that has no default",
    "R0505": "an object is unknown or of an unknown type",
    "R0506": "a trace has no states",
    # 6: scenarios and graphs
    "R0601": "a scenario's name is unknown",
    "R0602": "a scenario file is not text in TOML",
    "R0603": "a field of a scenario is missing or unknown",
    "R0604": "a field's value in a scenario does not fit",
    "R0605": "parts of a scenario contradict each other",
    "R0606": "horizon and step do not fit together",
    "R0607": "ego has no free cell to start from",
    "R0608": "a partition or an adjacency is unknown",
    "R0609": "a path does not follow the navigation graph",
    # 7: files
    "R0701": "a file cannot be read",
    "R0702": "a file cannot be written",
    "R0703": "a name was not found on the search path",
}
