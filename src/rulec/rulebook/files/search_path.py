"""Search path of rulebooks and vocabularies, with rulec's own last."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from rulec.diagnostics import Label, RulecError, Span, did_you_mean, named, nearest_name
from rulec.diagnostics.ways_out import offering
from rulec.files.read_files import MAX_SOURCE_BYTES, opened, what_reads
from rulec.files.source_detection import LEAD_BYTES, beginning_of, first_word_at
from rulec.files.work_trees import refuse_no_source
from rulec.resources import rulebooks_folder
from rulec.rulebook.files.open_documents import open_text
from rulec.rulebook.files.reference_messages import NAME_NOT_FOUND
from rulec.rulebook.files.source_walk import SUFFIX, rules_files

_PACKED = ".json.gz"
_DOCUMENTS = (".doc", ".docx", ".odt", ".pdf", ".rtf")

BY_PATH = "a file is given by its path, such as `./mine.rules`"


@dataclass(frozen=True, slots=True)
class Dependency:
    """Dependency of the file ``user`` (empty for none) on another, with its content's hash."""

    kind: Literal["base", "vocabulary"]
    name: str
    user: str
    path: str
    sha256: str


def find_rulebook(reference: str | Path, search_path: Sequence[Path]) -> Path:
    """The file of a rulebook, given by name or by a path with ``/`` or ``.rules`` in it.

    Raises RulecError R0703 with the nearest name and all those available.
    """
    text = str(reference)
    if text == "-":
        # Whatever files are called: a file of this name is `./-`.
        raise NAME_NOT_FOUND.error(
            None,
            "standard input is no rulebook that can be found",
            help="write it to a file, or give its text; `-` is for commands alone",
        )
    if "/" in text or text.endswith(SUFFIX):
        path = Path(text)
        inside = path / f"{path.name}{SUFFIX}"
        return inside if _is_file(inside) else path
    by_name = _by_name(text, search_path)
    if by_name is not None:
        return by_name
    known = available_rulebooks(search_path)
    way_out = meant_by(text, known, search_path)
    raise NAME_NOT_FOUND.error(
        None, f"there is no rulebook `{text}`", help=way_out, notes=(BY_PATH,)
    )


def meant_by(name: str, known: Sequence[str], search_path: Sequence[Path]) -> str:
    """Help for an unknown name: a file with another ending, or a country."""
    if "." in name and _is_file(Path(name)):
        if Path(name).suffix.lower() in _DOCUMENTS:
            return f"save it as plain text, in UTF-8, with a name that ends in `{SUFFIX}`"
        if name.lower().endswith(_PACKED):
            shorter = name[: -len(".gz")]
            return f"a compiled rulebook's name ends in `.json`, packed or not: call it `{shorter}`"
        if _lead(Path(name)) not in ("rulebook", "vocabulary"):
            otherwise = f"`rulec verify {name} -r de` judges traffic by one"
            return f"this file is no rulebook; {what_reads(name) or otherwise}"
        renamed = Path(name).with_suffix(SUFFIX).name
        return f"the name of a rulebook's file ends in `{SUFFIX}`: call it `{renamed}`"
    if locate_vocabulary(name, None, search_path) is not None:
        return f"`{name}` is a vocabulary, in whose words rulebooks such as `de` are written"
    shipped = {path.stem for path in rules_files(rulebooks_folder())}
    # Of many names the first are shown: the reader's own are those that are not known anyway.
    beside = [
        f"./{path}" for path in sorted(Path().glob(f"*{SUFFIX}")) if _lead(path) == "rulebook"
    ]
    own = [*beside, *(known_name for known_name in known if known_name not in shipped)]
    that_ship = [known_name for known_name in known if known_name in shipped]
    return _by_title(name, known, search_path) or suggest(name, [*own, *that_ship])


def _by_name(name: str, search_path: Sequence[Path]) -> Path | None:
    for folder in (*search_path, rulebooks_folder()):
        for candidate in (folder / f"{name}{SUFFIX}", folder / name / f"{name}{SUFFIX}"):
            if name and _is_file(candidate):
                return candidate
    return None


def available_rulebooks(search_path: Sequence[Path] = ()) -> tuple[str, ...]:
    """The names that ``find_rulebook`` knows, in alphabetical order."""
    names = {
        path.stem
        for folder in (*search_path, rulebooks_folder())
        for path in rules_files(folder)
        if path.parent == folder or path.stem == path.parent.name
        if _lead(path) == "rulebook"
    }
    return tuple(sorted(names))


def rulebook_texts(
    search_path: Sequence[Path] = (), names: Sequence[str] | None = None
) -> Iterator[tuple[Path, str]]:
    """The files and texts of the rulebooks of these names, or of all that can be read."""
    for name in available_rulebooks(search_path) if names is None else names:
        with suppress(RulecError):
            path = find_rulebook(name, search_path)
            yield path, read_bytes(path).decode(errors="replace")


def available_vocabularies(
    search_path: Sequence[Path] = (), user: Path | None = None
) -> tuple[Path, ...]:
    """Files of all vocabularies, by name, those beside the rulebook ``user`` included."""
    first: dict[str, Path] = {}
    for folder in _vocabulary_folders(user, search_path):
        for path in rules_files(folder):
            if path.parent == folder and _lead(path) == "vocabulary":
                first.setdefault(path.stem, path)
    return tuple(first[name] for name in sorted(first))


def available_files(search_path: Sequence[Path] = ()) -> tuple[str, ...]:
    """The files of all available rulebooks and vocabularies."""
    books = [find_rulebook(name, search_path) for name in available_rulebooks(search_path)]
    return tuple(map(str, (*books, *available_vocabularies(search_path))))


def find_vocabulary(name: str, use: Span, user: Path | None, search_path: Sequence[Path]) -> Path:
    """The file of a vocabulary: beside its user, on the search path, or rulec's own.

    Raises RulecError R0703 at the ``use`` line.
    """
    path = locate_vocabulary(name, user, search_path)
    if path is None:
        known = [path.stem for path in available_vocabularies(search_path, user)]
        other = locate_base(name, user, search_path) is not None
        by = f"`{name}` is a rulebook: `extends {name}`" if other else ""
        raise _not_found("vocabulary", name, use, known, by=by)
    return path


def locate_vocabulary(name: str, user: Path | None, search_path: Sequence[Path]) -> Path | None:
    """The vocabulary's file as ``find_vocabulary`` finds it; None if there is none."""
    for folder in _vocabulary_folders(user, search_path):
        candidate = folder / f"{name}{SUFFIX}"
        if _is_file(candidate) and (user is None or not is_same_file(candidate, user)):
            return candidate
    return None


def find_base(name: str, line: Span, user: Path | None, search_path: Sequence[Path]) -> Path:
    """The file of a base: beside its user, on the search path, or rulec's own.

    Raises RulecError R0703 at the ``extends`` line.
    """
    path = locate_base(name, user, search_path)
    if path is None:
        known = available_rulebooks([*_around(user), *search_path])
        looked = (
            f"`{name}{SUFFIX}` is looked for beside this file, on the search path, and in rulec"
        )
        folders = [*_around(user), *search_path]
        by = _by_title(name, known, folders)
        if locate_vocabulary(name, user, search_path) is not None:
            by = f"`{name}` is a vocabulary: `use {name}`"
        raise _not_found("rulebook", name, line, known, looked, by=by)
    return path


OWN_NAMES = {
    "at": ("österreich", "oesterreich", "autriche"),
    "be": ("belgique", "belgië", "belgie", "belgien"),
    "ch": ("schweiz", "suisse", "svizzera"),
    "cn": ("中国", "zhongguo", "chine"),
    "de": ("deutschland", "allemagne", "stvo"),
    "es": ("españa", "espana", "spanien", "espagne"),
    "fr": ("frankreich", "code de la route"),
    "gb": ("uk", "england", "britain", "great britain", "highway code"),
    "ie": ("éire", "eire"),
    "in": ("bharat",),
    "it": ("italia", "italien", "italie"),
    "jp": ("日本", "nippon", "nihon", "japon"),
    "kr": ("한국", "hanguk", "south korea"),
    "nl": ("nederland", "holland", "niederlande"),
    "pl": ("polska", "polen"),
    "se": ("sverige", "schweden"),
    "us": ("usa", "america"),
    "us-ca": ("ca", "calif"),
}
"""What inhabitants, neighbours and lawyers call the countries whose rulebooks ship."""

_TITLE = re.compile(r'^title[ \t]+"([^"\n]*)"', re.M)


def _by_title(name: str, known: Sequence[str], search_path: Sequence[Path]) -> str:
    """The rulebooks whose title begins with a name, such as a country's; empty if there is none."""
    titled = []
    for path, text in rulebook_texts(search_path, known):
        title = _TITLE.search(text)
        shown = title[1] if title else ""
        fits = len(name) > 3 and shown.casefold().startswith(name.casefold())
        if fits or name.casefold() in OWN_NAMES.get(path.stem, ()):
            titled.append(f"`{path.stem}` ({shown})")
    return f"did you mean {' or '.join(titled)}?" if titled else ""


def _not_found(
    kind: str, name: str, place: Span, known: Sequence[str], *notes: str, by: str = ""
) -> RulecError:
    """The error that there is no such file; ``by`` is help other than by similarity."""
    return NAME_NOT_FOUND.error(
        place,
        f"there is no {kind} `{name}`",
        expected=f"expected the name of a {kind}",
        help=by or offering(_suggest(name, known), *filter(None, (nearest_name(name, known),))),
        notes=notes,
    )


def locate_base(name: str, user: Path | None, search_path: Sequence[Path]) -> Path | None:
    """The base's file as ``find_base`` finds it; None if there is none."""
    return _by_name(name, [*_around(user), *search_path])


def _around(user: Path | None) -> list[Path]:
    if user is None:
        return []
    return [user.parent, *([user.parent.parent] if _has_own_folder(user) else [])]


def _has_own_folder(user: Path) -> bool:
    """Whether a rulebook is in a folder of its name, such as `de/de.rules`, beside the others'."""
    return user.parent.name == user.stem


def read_bytes(path: Path, use: Span | None = None) -> bytes:
    """A file's bytes, up to just above the size limit. Raises RulecError R0701, R0730, R0731.

    ``use`` is the line that asks for the file.
    """
    labels = (Label(use.place, "it is used here"),) if use else ()
    shown = open_text(path)
    if shown is not None:
        return shown
    refuse_no_source(path, labels)
    with opened(path, _instead_of(path), labels=labels) as stream:
        return stream.read(MAX_SOURCE_BYTES + 1)


def _instead_of(path: Path) -> str:
    """Help where a file cannot be read: the shipped rulebook of that name."""
    if not os.path.lexists(path) and _by_name(path.stem, ()) is not None:
        return f"`{path.stem}` ships with rulec: leave out `{SUFFIX}`"
    return "check its name and its permissions"


def _vocabulary_folders(user: Path | None, search_path: Sequence[Path]) -> list[Path]:
    beside = [] if user is None else [user.parent, user.parent / "vocabulary"]
    if user is not None and _has_own_folder(user):
        beside.append(user.parent.parent / "vocabulary")
    listed = [inner for folder in search_path for inner in (folder, folder / "vocabulary")]
    return [*beside, *listed, rulebooks_folder() / "vocabulary"]


def _is_file(path: Path) -> bool:
    # A file that an editor has not saved yet is there, too.
    return os.path.isfile(path) or open_text(path) is not None  # noqa: PTH113 - Path raises on a null character


def is_same_file(path: Path, other: Path) -> bool:
    """Tell whether two paths lead to the same file."""
    with suppress(OSError):
        return path.samefile(other)
    return open_text(path) is not None and os.path.realpath(path) == os.path.realpath(other)


def _lead(path: Path) -> str:
    """The first word of a file, which tells its kind."""
    try:
        with path.open("rb") as stream:
            text = beginning_of(stream.read(LEAD_BYTES))
    except OSError:
        return ""
    return text[slice(*first_word_at(text))]


def suggest(name: str, known: Sequence[str]) -> str:
    """Suggestions for an unknown name in a command."""
    if name and _is_file(Path(f"{name}{SUFFIX}")):
        return f"write `./{name}{SUFFIX}` for the file in the working folder"
    return _suggest(name, known)


def _suggest(name: str, known: Sequence[str]) -> str:
    question = did_you_mean(name, known)
    shown = _some_of_both(known)
    available = f"available: {named(shown)}" if shown else "none is available"
    return f"{question} ({available})" if question else available


_MOST_OWN = 4
"""The most files of the reader's own that are named as long as others are available."""


def _some_of_both(known: Sequence[str]) -> list[str]:
    """Names with the first files of the working folder, then all the others."""
    own = [name for name in known if name.startswith("./")]
    return [*own[:_MOST_OWN], *(name for name in known if not name.startswith("./"))]
