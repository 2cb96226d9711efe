"""Files of Argoverse 2 that belong together, found by their names."""

from __future__ import annotations

from fnmatch import fnmatchcase
from pathlib import Path

from rulec.diagnostics import named
from rulec.files.read_files import is_folder
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import short

SCENARIO = "scenario_*.parquet"
ANNOTATIONS = "annotations*.feather"
POSES = "city_SE3_egovehicle.feather"
MAP = "log_map_archive_*.json"

_MOST_NAMED = 3


def is_named(path: Path, pattern: str) -> bool:
    """Whether a file has such a name, or a folder contains such a file."""
    return has(path, pattern) or (not is_folder(path) and fnmatchcase(path.name, pattern))


def has(folder: Path, pattern: str) -> bool:
    """Whether a folder contains such a file."""
    return is_folder(folder) and next(folder.glob(pattern), None) is not None


def only_in(path: Path, pattern: str, form: FileFormat) -> Path:
    """The file itself, or the only file with such a name in a folder. Raises RulecError R0610."""
    return _only(path, path, pattern, form, "name one of them") if is_folder(path) else path


def map_beside(path: Path, form: FileFormat) -> Path:
    """The map next to a file, or in the folder `map` there. Raises RulecError R0610."""
    folder = path.parent if has(path.parent, MAP) else path.parent / "map"
    return _only(path, folder, MAP, form, "name the map with --map FILE")


def _only(path: Path, folder: Path, pattern: str, form: FileFormat, way_out: str) -> Path:
    files = sorted(folder.glob(pattern)) if is_folder(folder) else []
    if len(files) == 1:
        return files[0]
    if not files:
        raise form.refused(path, f"there is no `{pattern}` beside it", help_text=way_out)
    some = named([short(file.name) for file in files[:_MOST_NAMED]])
    raise form.refused(path, f"there are {len(files)} beside it: {some}", help_text=way_out)
