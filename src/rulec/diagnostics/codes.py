"""The registry of diagnostic codes: what each kind of message is about, in one line.

The hundreds name the stage that speaks: 1 syntax, 2 names, 3 types and meaning, 4 compiling,
5 traces, 6 scenarios and graphs, 7 files.
"""

from __future__ import annotations

CODES: dict[str, str] = {
    # 1: syntax
    "R0101": "a file is not a text in UTF-8",
    "R0102": "a file is too large",
    "R0103": "a file is empty",
    "R0104": "something stands where the language has no place for it",
    "R0105": "a text has no closing quote",
    "R0106": "a text holds an unknown escape",
    "R0107": "a text holds a control character",
    "R0108": "a brace is missing or closes nothing",
    "R0109": "something stands outside the braces that it belongs in",
    "R0110": "a date is not in the calendar",
    "R0111": "a formula is too deep or too long",
    "R0112": "a number is too large",
    "R0113": "a word of the language is used as a name",
    "R0114": "something that must be there is missing",
    "R0115": "a line stands in the wrong part of a file",
    "R0116": "something is given twice",
    "R0117": "a file is no rulebook",
    # 2: names
    "R0201": "a type is unknown",
    "R0202": "a name in a formula or a state is unknown",
    "R0203": "a variable is unknown",
    "R0204": "a name is declared twice",
    "R0205": "two rules have the same name",
    "R0206": "a file is of another kind or name than expected",
    "R0207": "a variable is not used",
    # 3: types and meaning
    "R0301": "an atom has the wrong number of arguments",
    "R0302": "an argument is of the wrong type",
    "R0303": "a name stands for something that cannot be true or false",
    "R0304": "types are subtypes of one another in a circle",
    "R0305": "a default is not one of the values",
    "R0306": "a state contradicts itself",
    "R0307": "a state leaves open what has no default",
    "R0308": "a parameter's type is left out where it is not clear",
    "R0309": "a name can be read in two ways",
    "R0310": "a state denies a value instead of naming one",
    "R0311": "an operator speaks of a phase before `then`, not of the sequence",
    # 4: compiling
    "R0401": "the automaton of a rule would be too large",
    "R0402": "the compiled automaton failed its check against the formula",
    "R0403": "Spot is not installed",
    "R0404": "a compiled rulebook is damaged or of another version",
    "R0405": "a rulebook reads relations of two partitions",
    "R0406": "an example comes out otherwise than it says",
    # 5: traces
    "R0501": "a line is not a trace in JSON",
    "R0502": "a state uses a name that the vocabulary does not know",
    "R0503": "a state's value does not fit its declaration",
    "R0504": "a state lacks a value that has no default",
    "R0505": "an object is unknown or of an unknown type",
    "R0506": "a trace has no states",
    # 6: scenarios and graphs
    "R0601": "a scenario's name is unknown",
    "R0602": "a scenario file is too large or not TOML",
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
