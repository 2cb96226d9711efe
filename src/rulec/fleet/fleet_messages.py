"""Messages about the drives of fleets and where their findings are written."""

from __future__ import annotations

from pathlib import Path

from rulec.diagnostics import RulecError, SourceLocation, first_of, named
from rulec.diagnostics.code import Code, missing_package
from rulec.files.read_files import what_reads
from rulec.recordings.recording_messages import NET_MISSING

CUT_DRIVE = Code("R0709")

NO_DRIVES_TABLE = Code("R0710")


_MOST_NAMED = 8


def cut_drive(drive: str, why: str, keys: list[str]) -> RulecError:
    return CUT_DRIVE.error(
        None,
        f"{drive} is cut: {why}",
        help=f"group the rows by {named(keys)} first, so that each drive is in one table",
    )


def no_drives(columns: list[str], path: str = "") -> RulecError:
    some = first_of([f"`{name}`" for name in columns], _MOST_NAMED)
    return NO_DRIVES_TABLE.error(
        _place(path),
        f"the table has neither tracks nor traces; its columns are {some}",
        expected="expected `track`, `t`, `x`, `y` or `trace`, `step`",
        help="rename its columns as docs/fleet.md says",
    )


def twice_named(column: str, path: str = "") -> RulecError:
    return NO_DRIVES_TABLE.error(
        _place(path),
        f"the table has two columns `{column:.40}`",
        help="rename one of them, or leave it out",
    )


def almost_named(column: str, known: str, path: str = "") -> RulecError:
    return NO_DRIVES_TABLE.error(
        _place(path),
        f"the table's column `{column:.40}` is almost called `{known}`, which tells drives apart",
        help=f"call it `{known}` if that is meant; otherwise rename it, or leave it out",
    )


def unnamed_drives(why: str, path: str = "") -> RulecError:
    return NO_DRIVES_TABLE.error(
        _place(path),
        f"drives of the table cannot be told by their names: {why}",
        help="write the table's texts in UTF-8",
    )


def _place(path: str) -> SourceLocation | None:
    return SourceLocation(path) if path else None


NOT_COMPILED = Code("R0711")


def not_compiled(reference: str) -> RulecError:
    return NOT_COMPILED.error(
        None,
        f"`{reference}` is no compiled rulebook",
        help="give the file that `rulec compile` writes (.json), or what "
        "`rulec.compile_rulebook` returns",
    )


def no_map(name: str, why: str) -> RulecError:
    return NET_MISSING.error(
        None,
        f"recording `{name}`: {why}",
        help="give a map, or its path in a column `map`",
    )


def no_fleet_input(path: str, why: str = "") -> RulecError:
    return NO_DRIVES_TABLE.error(
        SourceLocation(path),
        "the file is neither a table of drives in Parquet nor recorded traffic"
        + (f": {why}" if why else ""),
        help=what_reads(path)
        or "write traces as Parquet, with the columns that docs/traces.md has, or give a "
        "recording; `rulec list formats` lists what is read",
    )


def other_types(path: str, why: str) -> RulecError:
    return NO_DRIVES_TABLE.error(
        SourceLocation(path),
        f"a drive of the file goes on where columns are of other types: {why}",
        help="write all tables of a fleet with the same types",
    )


OTHER_FLEET = Code("R0712")

ENGINE_MISSING = Code("R0713")


def other_fleet(folder: Path, why: str) -> RulecError:
    return OTHER_FLEET.error(
        SourceLocation(str(folder)),
        f"the folder has findings of another fleet: {why}",
        help="give another folder with -o, or the inputs and options of before",
    )


def no_fleet(folder: Path) -> RulecError:
    return OTHER_FLEET.error(
        SourceLocation(str(folder)),
        "the folder has files that are no findings of a fleet: among them is no _manifest.json",
        help="give a new or an empty folder with -o",
    )


def folder_in_use(folder: Path) -> RulecError:
    return OTHER_FLEET.error(
        SourceLocation(str(folder)),
        "another run of rulec is writing into the folder",
        help="wait until it has ended, and go on with what it has written, or give another folder "
        "with -o",
    )


def engine_missing(engine: str, package: str) -> RulecError:
    otherwise = "use `--on local`"
    return missing_package(ENGINE_MISSING, f"`--on {engine}`", package, engine, otherwise=otherwise)


def java_missing(home: str | None) -> RulecError:
    return ENGINE_MISSING.error(
        None,
        f"there is no Java in `{home}`, which JAVA_HOME names"
        if home
        else "Spark takes Java 17, and there is no `java` on the path",
        help="install Java 17 and let JAVA_HOME name its folder, or use `--on local`",
    )
