"""Advice after usage errors: an example, a similar word."""

from __future__ import annotations

import re
from collections.abc import Iterator

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.options.verb_class import invocation_of
from rulec.cli.verb_table import FORMER, OTHER_QUESTIONS, VERBS
from rulec.diagnostics import nearest_name

_TRACES = "`rulec maneuvers --traces s2 -r de -o traces.jsonl` writes some to try"
_RECORDINGS = "`rulec list formats` lists the formats of recorded traffic"

EXAMPLES = {
    "analyze": ("rulec analyze de",),
    "compile": ("rulec compile de -o build/de",),
    "compile --check": ("rulec compile --check build/de/de.json", "`rulec compile` writes one"),
    "diff": ("rulec diff de nl",),
    "doc": ("rulec doc de -o de.html",),
    "draw drive": ("rulec draw drive drive.xml -r de -o drive.svg", _RECORDINGS),
    "draw graph": ("rulec draw graph s2 -o graph.svg",),
    "draw scene": ("rulec draw scene s2 -r de -o scene.svg",),
    "draw trace": ("rulec draw trace traces.jsonl -r de -o trace.svg", _TRACES),
    "draw": ("rulec draw scene s2 -r de -o scene.svg",),
    "explain": ("rulec explain R0207",),
    "find": ("rulec find '(v: vehicle) gap(v) <= 10 m' traces.jsonl", _TRACES, _RECORDINGS),
    "fleet": ("rulec fleet drives -r de -o findings", _RECORDINGS),
    "help --completion": ("rulec help --completion bash",),
    "maneuvers --envelopes": ("rulec maneuvers --envelopes s2 -r de -o envelopes.csv",),
    "maneuvers --traces": ("rulec maneuvers --traces s2 -r de -o traces.jsonl",),
    "maneuvers": ("rulec maneuvers s2 -r de", "`rulec list scenarios` shows those that ship"),
    "monitor": ("rulec monitor de < states.jsonl",),
    "new": ("rulec new belgium",),
    "rates": ("rulec rates findings.csv", "`rulec verify --exposure -o findings.csv` writes one"),
    "show --audit": ("rulec show --audit de",),
    "show": ("rulec show de bus_leaving",),
    "verify": ("rulec verify traces.jsonl -r de", _TRACES, _RECORDINGS),
}
"""For each verb an example command, and where its input comes from."""

_EACH_SCENARIO = "`for s in s2 s3; do rulec {} $s -r de -o $s.{}; done`"
_ONE_EACH = {
    "draw drive": "`for f in *.xml; do rulec draw drive $f -r de -o $f.svg; done`",
    "draw graph": _EACH_SCENARIO.format("draw graph", "svg"),
    "draw scene": _EACH_SCENARIO.format("draw scene", "svg"),
    "draw trace": "`for f in *.jsonl; do rulec draw trace $f -r de -o $f.svg; done`",
    "maneuvers --envelopes": _EACH_SCENARIO.format("maneuvers --envelopes", "csv"),
    "maneuvers --traces": _EACH_SCENARIO.format("maneuvers --traces", "jsonl"),
    "monitor": "give each the states: `tee >(rulec monitor fr) < states.jsonl | rulec monitor de`",
}
"""For each verb with one question and one output file, how to ask several questions."""

_OF_OTHER_VERBS = {
    "--coverage": "`rulec test` has it",
    "--fix": "`rulec check` has it",
    "--lock": "`rulec check` has it",
    "--rule": "`rulec verify`, `rulec test`, `rulec show` and `rulec diff` have it",
    "--watch": "`rulec check` and `rulec test` have it",
    **{
        word: f"`rulec {verb}` has it"
        for verb, words in OTHER_QUESTIONS.items()
        for word in words
        if verb != "compile"
    },
}
"""Options that users may look for at the wrong verb."""

_NO_CHOICE = re.compile(r"'(?P<given>.*)' is not one of ")
_NO_NUMBER = re.compile(r"'(?P<given>.*)' is not a valid integer")
_OUT_OF_RANGE = re.compile(r"(?P<given>\S+) is not in the range ")
_TOO_MUCH = re.compile(r"Got unexpected extra arguments? \((?P<given>.*)\)")
_NO_COMMAND = re.compile(r"No such command '(?P<given>.*?)'\.")


def reworded(problem: click.ClickException) -> str:
    """The message, in the words used for sources, with a suggestion."""
    message = problem.format_message()
    if isinstance(problem, click.NoSuchOption) and problem.ctx is not None:
        return _no_option(problem.option_name, problem.ctx)
    param = problem.param if isinstance(problem, click.BadParameter) else None
    if isinstance(problem, click.BadParameter) and (wrong := _wrong_value(problem)):
        return wrong
    if isinstance(problem, click.BadOptionUsage) and message.endswith("requires an argument."):
        return f"{problem.option_name} is given without a value"
    if isinstance(problem, click.MissingParameter):
        if isinstance(param, click.Option):
            return f"{' or '.join(f'`{name}`' for name in param.opts)} is missing"
        if param is not None and problem.ctx is not None:
            return f"`{param.make_metavar(problem.ctx)}` is missing"
        return message
    if isinstance(param, click.Option):
        return f"{_as_typed(param, problem)}: {problem.message}"
    if match := _TOO_MUCH.match(message):
        words = match["given"].split()
        many = "an argument" if len(words) == 1 else f"{len(words)} arguments"
        return f"`{match['given']}` is {many} too many"
    context = getattr(problem, "ctx", None)
    if context is not None and (match := _NO_COMMAND.match(message)):
        names = context.command.list_commands(context)
        near = nearest_name(match["given"], names)
        way_out = f"did you mean `{near}`?" if near else f"it has {', '.join(names)}"
        return f"`{context.command_path}` has no command `{match['given']}`; {way_out}"
    return message


def _no_option(name: str, context: click.Context) -> str:
    """That a command has no such option, and where there is one."""
    params = context.command.params
    # An argument's name is nothing to type
    known = [text for own in params if isinstance(own, click.Option) for text in own.opts]
    if others := _OF_OTHER_VERBS.get(name):
        return f"there is no option `{name}` here; {others}"
    path = context.command_path
    general = [text for own in context.find_root().command.params for text in own.opts]
    if name in general and context.parent is not None:
        return f"`{name}` stands before the verb: `rulec {name} … {path.removeprefix('rulec ')} …`"
    if name in ("-r", "--rulebook") and "-r" not in known:
        names = {own.name for own in params if isinstance(own, click.Argument)}
        if names & {"rulebook", "rulebooks", "sources"}:
            return f"the rulebook is given without `{name}`, as in `{path} de`"
        others = "the verbs that judge have it, such as `rulec verify`"
        return f"there is no option `{name}` here; {others}"
    fitting = [text for text in known if text.startswith(name)]
    # Compared without dashes, which all options have.
    by_name = {text.lstrip("-"): text for text in known}
    near = nearest_name(name.lstrip("-"), by_name)
    likely = fitting[0] if fitting else by_name.get(near or "")
    return f"there is no option `{name}`{f'; did you mean `{likely}`?' if likely else ''}"


def _wrong_value(problem: click.BadParameter) -> str:
    """That a number or a choice is wrong, and what is right; empty for other problems."""
    param = problem.param
    if param is None:
        return ""
    typed = _as_typed(param, problem)
    match param.type:
        case click.types.IntParamType() if match := _NO_NUMBER.match(problem.message):
            return f"{typed}: `{match['given']}` is no whole number"
        case click.IntRange(min=low, max=high) | click.FloatRange(min=low, max=high) if (
            match := _OUT_OF_RANGE.match(problem.message)
        ):
            limits = f"from {low} to {high}" if high is not None else f"{low} or more"
            return f"{typed}: `{match['given']}` is out of range: it is {limits}"
        case click.Choice() as kind if match := _NO_CHOICE.search(problem.message):
            given, choices = match["given"], [str(choice) for choice in kind.choices]
            subject = "" if param.param_type_name == "argument" else f"{typed}: "
            likely = _OTHER_VALUES.get(given.casefold())
            near = likely if likely in choices else nearest_name(given, choices)
            every = f"it is one of {', '.join(choices)}"
            way_out = f"did you mean `{near}`? ({every})" if near else every
            return f"{subject}there is no `{given}`; {way_out}"
    return ""


def _as_typed(param: click.Parameter, problem: click.ClickException) -> str:
    """The name of an option as it was typed, among its names."""
    context = getattr(problem, "ctx", None)
    given = invocation_of(context).arguments
    typed = {word.partition("=")[0] for word in given}
    names = [*param.opts[-1:], *getattr(param, "former", ())]
    return next((name for name in names if name in typed), param.opts[-1])


def ways_out(problem: click.UsageError) -> Iterator[str]:
    """Examples of the command, if it lacks an argument."""
    context = problem.ctx
    if context is None:
        return
    missing = problem.param if isinstance(problem, click.MissingParameter) else None
    if missing is not None and missing.name in ("rulebook", "rulebooks"):
        yield from _rulebook_hint(context) or (
            "`rulec list rulebooks` shows the available ones, such as `de`",
        )
        return
    verb = context.command_path.removeprefix("rulec").strip()
    message = problem.format_message()
    if _TOO_MUCH.match(message):
        if verb in _ONE_EACH:
            yield f"it takes one at a time; for several {_ONE_EACH[verb]}"
        return
    if not isinstance(problem, click.MissingParameter) and not _NO_COMMAND.match(message):
        return
    example, *sources = EXAMPLES.get(verb, ("",))
    if example:
        yield f"such as `{example}`"
    yield from sources


def _rulebook_hint(context: click.Context) -> tuple[str, ...]:
    """A hint naming the argument that may be the rulebook, given without ``-r``."""
    given = invocation_of(context).arguments
    names = [
        word for word in given[1:] if word.endswith(".rules") or word in lazy.available_rulebooks()
    ]
    return tuple(f"a rulebook is given by `-r {name}`" for name in names[:1])


def unknown_verb(name: str) -> str:
    """The message for an unknown verb."""
    near = nearest_name(name, (*VERBS, *FORMER))
    verb = _OTHER_WORDS.get(name.casefold()) or FORMER.get(near or "", near)
    way_out = f"did you mean `{verb}`?" if verb else "`rulec help` lists them"
    if name.endswith(".rules") or name in lazy.available_rulebooks():
        way_out = f"to name a rulebook, put a command before it, as in `rulec check {name}`"
    return f"there is no command `{name}`; {way_out}"


_OTHER_VALUES = {
    **dict.fromkeys(("books", "countries", "laws", "rules"), "rulebooks"),
    **dict.fromkeys(("words", "signals", "types"), "vocabularies"),
    **dict.fromkeys(("hoa", "json", "python", "spot"), "automata"),
    **dict.fromkeys(("c++", "cpp", "cxx"), "c"),
    **dict.fromkeys(("nusmv", "nuxmv", "prism", "smv"), "ltl"),
}
"""Words that users may type instead of a valid value of an option or argument."""

_OTHER_WORDS = {
    "analyse": "analyze",
    "build": "compile",
    "compare": "diff",
    "coverage": "test --coverage",
    "create": "new",
    "docs": "doc",
    "format": "fmt",
    "info": "show",
    "init": "new",
    "judge": "verify",
    "lint": "check",
    "plan": "maneuvers",
    "plot": "draw",
    "run": "verify",
    "validate": "check",
    "version": "--version",
}
"""Names in other programs for what a verb does."""
