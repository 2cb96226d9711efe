"""The parts of the extension for Visual Studio Code that are generated from the language."""

from __future__ import annotations

import json
from typing import Any

from rulec.version import __version__
from tools.language_tokens import WORD, spellings

_PAIRS = (("LBRACE", "RBRACE"), ("LSQB", "RSQB"), ("LPAR", "RPAR"))


def package_manifest() -> str:
    """Generate ``package.json``."""
    return _json(
        {
            "name": "rulec",
            "displayName": "rulec",
            "description": "Traffic law as formulas: rulebooks, checked as you type",
            "version": __version__,
            "publisher": "rulec",
            "license": "GPL-3.0-or-later",
            "private": True,
            "engines": {"vscode": "^1.91.0"},
            "categories": ["Programming Languages", "Linters", "Formatters"],
            "keywords": ["traffic rules", "temporal logic", "LTL", "autonomous driving"],
            "main": "./dist/extension.js",
            "activationEvents": [],
            "contributes": {
                "languages": [
                    {
                        "id": "rulec",
                        "aliases": ["rulec", "Rulebook"],
                        "extensions": [".rules"],
                        "firstLine": rf"^\s*(?:{'|'.join(_first_words())})\b",
                        "configuration": "./language-configuration.json",
                    }
                ],
                "grammars": [
                    {
                        "language": "rulec",
                        "scopeName": "source.rulec",
                        "path": "./syntaxes/rulec.tmLanguage.json",
                    }
                ],
                "commands": [{"command": "rulec.restart", "title": "rulec: Restart the server"}],
                "configuration": {
                    "title": "rulec",
                    "properties": {
                        "rulec.command": {
                            "type": "array",
                            "items": {"type": "string"},
                            "minItems": 1,
                            "default": ["rulec"],
                            "scope": "machine-overridable",
                            "description": "The command that starts rulec, without its verb `lsp`.",
                        }
                    },
                },
                "configurationDefaults": {"[rulec]": {"editor.formatOnSave": True}},
            },
            "scripts": {
                "bundle": "esbuild extension.js --bundle --minify --platform=node --target=node20"
                " --external:vscode --outfile=dist/extension.js",
                "vscode:prepublish": "npm run bundle",
                "prepackage": "cp ../../../LICENSE . &&"
                " npm install --no-package-lock --no-audit --no-fund",
                "package": "vsce package --no-dependencies --allow-missing-repository",
            },
            "devDependencies": {
                "@vscode/vsce": "^3.9.2",
                "esbuild": "^0.28.0",
                "vscode-languageclient": "^11.0.0",
            },
        }
    )


def _first_words() -> list[str]:
    return [word for name in ("RULEBOOK", "VOCABULARY") for word in spellings()[name]]


def language_configuration() -> str:
    """Generate ``language-configuration.json``: comments, brackets, words, indentation."""
    brackets = [[spellings()[part][0] for part in pair] for pair in _PAIRS]
    opened, closed = brackets[0]
    quote = '"'
    return _json(
        {
            "comments": {"lineComment": "#"},
            "brackets": brackets,
            "autoClosingPairs": [
                *({"open": pair[0], "close": pair[1]} for pair in brackets),
                {"open": quote, "close": quote, "notIn": ["string", "comment"]},
            ],
            "surroundingPairs": [*brackets, [quote, quote]],
            "wordPattern": {"pattern": WORD, "flags": "u"},
            "indentationRules": {
                "increaseIndentPattern": rf"^[^#\"]*\{opened}[^{closed}\"]*$",
                "decreaseIndentPattern": rf"^\s*\{closed}",
            },
        }
    )


def _json(data: dict[str, Any]) -> str:
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"
