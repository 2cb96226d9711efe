"""A project's ``rulec.toml``, from the working folder or above it."""

from __future__ import annotations

from pathlib import Path

from rulec.diagnostics import RulecError, SourceLocation, did_you_mean
from rulec.file_messages import WRONG_SETTINGS
from rulec.files import decoded, opened
from rulec.toml import parsed_toml

FILE_NAME = "rulec.toml"
_HOW = 'such as `search_path = ["rulebooks"]`'


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
    with opened(file) as stream:
        source = decoded(str(file), stream.read())
    settings = parsed_toml(source, WRONG_SETTINGS, _HOW)
    for name in settings:
        if name != "search_path":
            way_out = did_you_mean(name, ["search_path"]) or "the one setting is `search_path`"
            raise _wrong(file, f"there is no setting `{name}`", way_out)
    folders = settings.get("search_path", [])
    if not isinstance(folders, list) or not all(isinstance(item, str) for item in folders):
        raise _wrong(file, "`search_path` is not a list of folders", _HOW)
    result = [file.parent / item for item in folders]
    for item, path in zip(folders, result, strict=True):
        if not path.is_dir():
            raise _wrong(
                file,
                f"`search_path` names `{item}`, which is no folder",
                f"it is looked for at `{path}`",
            )
    return tuple(result)


def _wrong(file: Path, message: str, way_out: str) -> RulecError:
    return WRONG_SETTINGS.error(SourceLocation(str(file)), message, help=way_out)
