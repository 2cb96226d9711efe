"""A project's ``rulec.toml``, from the working folder or above it."""

from __future__ import annotations

import stat
from pathlib import Path

from rulec.diagnostics import RulecError, SourceLocation, did_you_mean
from rulec.file_messages import OUT_OF_TREE, WRONG_SETTINGS
from rulec.files import MAX_SETTINGS_BYTES, decoded, opened, read_whole
from rulec.toml import parsed_toml
from rulec.work_trees import leads_out, refuse_link_out, tree_of

FILE_NAME = "rulec.toml"
_HOW = 'such as `search_path = ["rulebooks"]`'
_INSIDE = (
    "name a folder relative to the file, in the same git work tree, or without one below the file"
)
_LONGEST_NAME = 100


def search_path(folder: Path | None = None) -> tuple[Path, ...]:
    """Folders searched first for rulebooks and vocabularies.

    Args:
        folder: where to look for ``rulec.toml``, and above which, if not in the working folder; no
            such file means no folders.

    Raises RulecError: R0701 if it cannot be read, R0101 or R0704 for what is wrong in it.
    """
    folder = folder or Path.cwd()
    for place in (folder, *folder.parents):
        file = place / FILE_NAME
        if file.is_file():
            return _folders(file)
    return ()


def _folders(file: Path) -> tuple[Path, ...]:
    refuse_link_out(file)
    with opened(file) as stream:
        source = decoded(str(file), read_whole(stream, file, MAX_SETTINGS_BYTES))
    settings = parsed_toml(source, WRONG_SETTINGS, _HOW)
    for name in settings:
        if name != "search_path":
            way_out = did_you_mean(name, ["search_path"]) or "the one setting is `search_path`"
            raise _wrong(file, f"there is no setting `{name}`", way_out)
    folders = settings.get("search_path", [])
    if not isinstance(folders, list) or not all(isinstance(item, str) for item in folders):
        raise _wrong(file, "`search_path` is not a list of folders", _HOW)
    result = [file.parent / item for item in folders]
    tree = tree_of(file.parent)
    for item, path in zip(folders, result, strict=True):
        try:
            is_folder = stat.S_ISDIR(path.stat().st_mode)
        except (OSError, ValueError):  # also too long a name, and one with a null character
            is_folder = False
        if "\0" in item or Path(item).is_absolute() or leads_out(path, tree):
            raise OUT_OF_TREE.error(
                SourceLocation(str(file)),
                f"`search_path` names `{_cut(item)}`, which is not in the tree of the file",
                help=_INSIDE,
            )
        if not is_folder:
            raise _wrong(
                file,
                f"`search_path` names `{_cut(item)}`, which is no folder",
                f"it is looked for in `{file.parent}`",
            )
    return tuple(result)


def _cut(name: str) -> str:
    return name if len(name) <= _LONGEST_NAME else f"{name[:_LONGEST_NAME]}…"


def _wrong(file: Path, message: str, way_out: str) -> RulecError:
    return WRONG_SETTINGS.error(SourceLocation(str(file)), message, help=way_out)
