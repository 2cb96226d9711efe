"""The table of all engines. What one of them cannot do stands there, with the reason."""

from support.engines.engine import (
    ANY_STEP,
    EMPTY,
    FORM,
    OBJECTS,
    ONE_STATE,
    REFUSALS,
    STEPS,
    Engine,
)
from support.engines.graph_engines import after, as_a_trace, count, path, saved
from support.engines.monitor_engines import watched
from support.engines.trace_engines import (
    across,
    as_it_is,
    by_oracle,
    command,
    compiled_file,
    one_by_one,
    repeated,
    stacked,
    state_by_state,
    through,
    with_own_names,
    with_own_states,
)
from support.engines.word_engines import by_hoa, by_spot, direct, on_bits, word_by_word

TABLES = {
    EMPTY: "a table has a row for each state: without any there is no trace",
    FORM: "what is said of nobody is in no row",
}
NO_LAYERS = {EMPTY: "a graph has a first layer"}
STATES_COME = {EMPTY: "before the first state there is nothing to judge"}
WORDS = {
    STEPS: "it knows one word, and not what could follow",
    REFUSALS: "it is given letters that have been read",
    FORM: "it is given letters that have been read",
    EMPTY: "a word has a first letter",
}
ENGINES = {
    "second reading": Engine(
        by_oracle, {FORM: "it only reads what fits", ANY_STEP: "it knows them all"}
    ),
    "one by one": Engine(one_by_one),
    "state by state": Engine(state_by_state),
    "compiled file": Engine(compiled_file),
    "together, in cells": Engine(repeated(as_it_is)),
    "together, in columns": Engine(repeated(with_own_states)),
    "together, with names of their own": Engine(repeated(with_own_names)),
    "together, in arrays": Engine(stacked),
    "JSON Lines": Engine(through("jsonl")),
    "rulec verify": Engine(command("jsonl")),
    "rulec verify, CSV": Engine(command("csv"), TABLES),
    "rulec verify, Parquet": Engine(command("parquet"), TABLES),
    "CSV": Engine(through("csv"), TABLES),
    "Parquet": Engine(through("parquet"), TABLES),
    "monitor": Engine(watched(lambda n, length: False), STATES_COME),
    "monitor restored once": Engine(watched(lambda n, length: n == length // 2), STATES_COME),
    "monitor restored always": Engine(watched(lambda n, length: True), STATES_COME),
    "path of a graph": Engine(path, NO_LAYERS),
    "counts of a graph": Engine(
        count, {**NO_LAYERS, OBJECTS: "objects for which all is the same count together"}
    ),
    "graph after a trace": Engine(
        after(as_a_trace),
        {**NO_LAYERS, ONE_STATE: "one state for the past, one for the graph"},
    ),
    "graph after a saved monitor": Engine(
        after(saved), {**NO_LAYERS, ONE_STATE: "one state for the past, one for the graph"}
    ),
    "bits across": Engine(across, {**WORDS, REFUSALS: "it is given columns that have been read"}),
    "bits along": Engine(word_by_word(on_bits), WORDS),
    "direct evaluation": Engine(word_by_word(direct), WORDS),
    "HOA": Engine(word_by_word(by_hoa), WORDS),
    "Spot": Engine(word_by_word(by_spot), WORDS),
}
