"""Engines that judge whole traces: one by one, many together, out of files, on bits."""

import io
import json
import tempfile
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import replace
from pathlib import Path

from rulec.automata.bundle.bundle_file import from_json, to_json
from rulec.cli.main import main
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.batch_verify import verify_many
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.batch.verify_arrays import verify_arrays
from rulec.monitoring.verdict import NotJudged
from rulec.trace.formats.trace_files import kinds_in, read_chunks, write_traces
from rulec.vocabulary import Enumeration, Quantity, Signal
from support.builders.array_traces import CannotSayError, in_arrays
from support.builders.trace_columns import columnize, group_traces
from support.engines.engine import each, told
from support.oracles.bits.bit_verdicts import verify_on_bits
from support.oracles.presence import there
from support.oracles.rulebook_oracle import Oracle, Refused, Said
from support.oracles.state_oracle import as_facts_have_it, below


@each
def by_oracle(rulebook, compiled, trace):
    found = Oracle(rulebook).judged(trace)
    return min(found.codes) if isinstance(found, Refused) else found


def one_by_one(rulebook, compiled, traces):
    return [told(_verified(trace, compiled)) for trace in traces]


def _verified(trace, compiled):
    try:
        return verify(trace, compiled)
    except RulecError as error:
        return NotJudged(trace.id, error)


def state_by_state(rulebook, compiled, traces):
    return [told(verify_or_reason(trace, compiled)) for trace in traces]


def compiled_file(rulebook, compiled, traces):
    again = from_json(to_json(compiled).encode(), "book.json")
    return one_by_one(rulebook, again, traces)


def command(form):
    """``rulec verify``, with its files; there are several traces like each."""

    def judge_all(rulebook, compiled, traces):
        every = [replace(one, id=f"{one.id}~{n}") for n in range(COPIES) for one in traces]
        kinds = kinds_in(state for trace in traces for state in trace.states)
        with tempfile.TemporaryDirectory() as folder:
            rules, file = Path(folder, "book.json"), Path(folder, f"traces.{form}")
            rules.write_text(to_json(compiled), encoding="utf-8")
            with file.open("wb") as stream:
                write_traces(every, stream, str(file), form, kinds)
            out = io.StringIO()
            with redirect_stdout(out), redirect_stderr(io.StringIO()):
                main(["verify", str(file), "-r", str(rules), "--json"])
        return alike([answered(json.loads(line)) for line in out.getvalue().splitlines()])

    return judge_all


COPIES = 8


def alike(answers):
    """The answers to the first copies, which are those to the others."""
    first = answers[: len(answers) // COPIES]
    assert answers == first * COPIES
    return first


def answered(line):
    if "error" in line:
        return line["error"]["code"]
    return tuple(
        sorted(
            Said(
                one["rule"],
                tuple(one["binding"].values()),
                -1 if one["step"] is None else one["step"],
                one["strength"],
            )
            for one in line["violations"]
        )
    )


def repeated(copy):
    """Many together: several copies of each trace, among those of the others."""

    def judge_all(rulebook, compiled, traces):
        many = [copy(trace, n) for n in range(COPIES) for trace in traces]
        return alike([in_common_names(told(one)) for one in verify_many(many, compiled)])

    return judge_all


def together(rulebook, compiled, traces):
    return [told(one) for one in verify_many(traces, compiled)]


def stacked(rulebook, compiled, traces):
    """In arrays, whatever their objects; what these cannot say is judged one by one."""
    answers, arrays = {}, {}
    for place, trace in enumerate(traces):
        with suppress(CannotSayError):
            arrays[place] = in_arrays(trace, rulebook.vocabulary)
        if place not in arrays:
            answers[place] = verify_or_reason(trace, compiled)
    answers |= zip(arrays, verify_arrays(list(arrays.values()), compiled), strict=True)
    return [told(answers[place]) for place in range(len(traces))]


def as_it_is(trace, number):
    return trace


def with_own_names(trace, number):
    """Its objects are called otherwise than those of other copies."""
    names = {name: f"{name}~{number}" for name in trace.objects}
    states = tuple(renamed(state, names) for state in trace.states)
    objects, present = renamed(trace.objects, names), renamed(trace.present, names)
    return replace(trace, objects=objects, states=states, present=present)


def renamed(value, names):
    if not isinstance(value, dict):
        return value
    return {names.get(name, name): renamed(inner, names) for name, inner in value.items()}


def in_common_names(answer):
    if isinstance(answer, str):
        return answer
    own = (replace(one, objects=tuple(map(first_part, one.objects))) for one in answer)
    return tuple(sorted(own))


def first_part(name):
    return name.split("~")[0]


def with_own_states(trace, number):
    """As if read from columns: no state is met again."""
    return replace(trace, states=tuple(json.loads(json.dumps(trace.states))))


def through(form):
    """Written to a file of a format, and read back."""

    def judge_all(rulebook, compiled, traces):
        stream = io.BytesIO()
        kinds = kinds_in(state for trace in traces for state in trace.states)
        write_traces(traces, stream, "file", form, kinds)
        stream.seek(0)
        again = [one for chunk in read_chunks(stream, "file", form) for one in chunk]
        return one_by_one(rulebook, compiled, again)

    return judge_all


def across(rulebook, compiled, traces):
    """On bits, eight traces in a byte: those of one shape together."""
    shapes = {}
    for trace in traces:
        trace = as_facts_have_it(rulebook, trace)
        full = replace(
            trace,
            states=tuple(filled(trace, n, compiled.vocabulary) for n in range(len(trace.states))),
        )
        shape = repr((trace.step_s, trace.objects, trace.present))
        shapes.setdefault(shape, []).append(full)
    strengths = {rule.name: rule.strength for rule in compiled.rules}
    found = {trace.id: [] for trace in traces}
    for alike in shapes.values():
        group = group_traces(alike)
        columns = columnize(group.cells, compiled.vocabulary)
        for task, kept in verify_on_bits(columns, compiled):
            for place, keeps in zip(group.order, kept.tolist(), strict=True):
                if not keeps:
                    rule, objects = task.rule.name, tuple(task.objects.values())
                    found[alike[place].id].append(Said(rule, objects, None, strengths[rule]))
    return [tuple(sorted(found[trace.id])) for trace in traces]


def filled(trace, n, vocabulary):
    """A state that says something of every name; what it has left out, nothing reads."""
    objects, state = there(trace, n), {}
    for name, declaration in vocabulary.declarations.items():
        anything = declaration.default
        if anything is None:
            anything = {Signal: False, Quantity: 0}.get(type(declaration), "")
        if isinstance(declaration, Enumeration):
            anything = anything or declaration.values[0]
        groups = [
            [one for one, own in objects.items() if below(own, kind, vocabulary.types)]
            for kind in declaration.parameters
        ]
        state[name] = full(trace.states[n].get(name), anything, groups)
    return state


def full(value, anything, groups):
    if not groups:
        return anything if value is None else value
    return {name: full((value or {}).get(name), anything, groups[1:]) for name in groups[0]}
