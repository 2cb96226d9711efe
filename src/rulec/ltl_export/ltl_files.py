"""A rulebook's rules as files for Spot, PRISM and nuXmv, and the meaning of their propositions."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path

from rulec.automata.compiler import RulebookFormulas
from rulec.files.file_sets import write_together
from rulec.files.written_files import make_folder
from rulec.ltl_export.ltl_terms import NUXMV, PRISM, SPOT, TRUE, Term, text_of
from rulec.ltl_export.rule_terms import Proposition, RuleTerms, fresh_identifier, rule_terms
from rulec.rulebook.rulebook_model import Rulebook
from rulec.rulebook.vocabulary_phrases import phrases_of
from rulec.version import __version__


def write_ltl(rulebook: Rulebook, lowered: RulebookFormulas, folder: Path) -> list[Path]:
    """Write ``R.csv``, ``R.props``, ``R.smv`` and ``R.propositions.json`` of a rulebook R.

    Writes all files or none; returns the paths. Raises RulecError R0702, R0754.
    """
    phrases = phrases_of(rulebook)
    rules = [rule_terms(rulebook, formula, phrases) for formula in lowered.rules]
    texts = {
        f"{rulebook.name}.csv": spot_table(rules),
        f"{rulebook.name}.props": prism_properties(rulebook, rules),
        f"{rulebook.name}.smv": nuxmv_modules(rulebook, rules),
        f"{rulebook.name}.propositions.json": meanings(rulebook, rules),
    }
    make_folder(folder)
    write_together(folder, {name: text.encode() for name, text in texts.items()})
    return [folder / name for name in texts]


def spot_table(rules: Sequence[RuleTerms]) -> str:
    """One row per rule: rule, formula (read by Spot with ``-F R.csv/-2``), facts, history."""
    table = io.StringIO()
    rows = csv.writer(table, lineterminator="\n")
    rows.writerow(["rule", "formula", "facts", "history"])
    for terms in rules:
        texts = (text_of(term, SPOT) for term in (terms.formula, terms.facts, terms.history))
        rows.writerow([terms.rule.name, *texts])
    return table.getvalue()


def prism_properties(rulebook: Rulebook, rules: Sequence[RuleTerms]) -> str:
    """Three properties per rule; the model has to define the labels."""
    lines = [
        *_head(rulebook, "//"),
        f"// Labels have the meanings in {rulebook.name}.propositions.json. The model must define",
        "// them so that facts and history hold with probability 1, or they do not mean that.",
    ]
    for terms in rules:
        name = fresh_identifier(terms.rule.name, set())
        lines += ["", f"// {terms.rule.strength} rule"]
        lines.append(f'"{name}": P=? [ {text_of(terms.formula, PRISM)} ];')
        for title, term in (("facts", terms.facts), ("history", terms.history)):
            if term != TRUE:
                lines.append(f'"{name}_{title}": P=? [ {text_of(term, PRISM)} ];')
    return "\n".join(lines) + "\n"


def nuxmv_modules(rulebook: Rulebook, rules: Sequence[RuleTerms]) -> str:
    """A module per rule with its propositions as parameters, and a main module that frees them."""
    finite = rulebook.semantics == "finite"
    lines = [*_head(rulebook, "--")]
    main: list[str] = ["MODULE main", "VAR"]
    for terms in rules:
        name = fresh_identifier(f"rule {terms.rule.name}", set())
        own = [each.name for each in terms.propositions] + ["alive"] * finite
        lines += ["", f"-- {terms.rule.strength} rule", f"MODULE {name}({', '.join(own)})"]
        if terms.past:
            lines += ["VAR", *(f"  {each.name} : boolean;" for each in terms.past)]
        assumed = [term for term in (terms.facts, terms.history) if term != TRUE]
        whole = terms.formula
        for term in reversed(assumed):
            whole = Term("->", (term, whole))
        lines.append(f"LTLSPEC NAME {name}_is_kept := {text_of(whole, NUXMV)};")
        given = [f"{name}_{each}" for each in own]
        main += [f"  {each} : boolean;" for each in given]
        main.append(f"  {name}_here : {name}({', '.join(given)});")
    free = (
        "-- All propositions are free here, and what rules forbid happens: put a model in its place"
    )
    return "\n".join([*lines, "", free, *main, ""])


def meanings(rulebook: Rulebook, rules: Sequence[RuleTerms]) -> str:
    """The meaning of each proposition, with the sources."""
    document = {
        "version": 1,
        "rulebook": rulebook.name,
        "rulec": __version__,
        "sources": [{"name": file.name, "sha256": file.sha256} for file in rulebook.sources],
        "semantics": rulebook.semantics,
        "rules": {
            terms.rule.name: {
                "strength": terms.rule.strength,
                "cite": terms.rule.cite,
                "step_s": None if terms.step_s is None else str(terms.step_s),
                "propositions": {each.name: _meaning(each) for each in terms.propositions},
                "an_instant_ago": {each.name: each.formula for each in terms.past},
            }
            for terms in rules
        },
    }
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def _meaning(proposition: Proposition) -> dict[str, str]:
    return {"formula": proposition.formula, "says": proposition.says}


def _head(rulebook: Rulebook, sign: str) -> list[str]:
    sources = ", ".join(file.sha256[:16] for file in rulebook.sources)
    written = f"{sign} Rulebook {rulebook.name}, written by rulec {__version__}"
    return [f"{written}; SHA-256 of its sources begin with {sources}."]
