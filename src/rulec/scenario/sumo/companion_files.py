"""The files that belong to floating-car data, by name or beside them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from html import unescape
from pathlib import Path, PurePosixPath

from rulec.diagnostics import SourceLocation, named
from rulec.scenario.scenario_messages import NET_MISSING

_OPTION = re.compile(r'<(net-file|route-files|additional-files|fcd-output\.geo)\s+value="([^"]*)"')


@dataclass(frozen=True, slots=True)
class FcdHead:
    """SUMO's configuration, a comment at the head of its output."""

    net: str = ""
    demand: tuple[str, ...] = ()
    geographic: bool = False


def fcd_head(comment: str) -> FcdHead:
    """The configuration in a comment, as far as it matters here."""
    options = {name: unescape(value) for name, value in _OPTION.findall(comment)}
    demand = [
        name.strip()
        for key in ("route-files", "additional-files")
        for name in options.get(key, "").split(",")
    ]
    return FcdHead(
        options.get("net-file", ""),
        tuple(filter(None, demand)),
        options.get("fcd-output.geo") in ("true", "1", "yes", "on"),
    )


def net_beside(path: Path, head: FcdHead) -> Path:
    """The net of floating-car data.

    Raises:
        RulecError: R0614 if it is not clear which that is.
    """
    written = _beside(path, head.net) if head.net else None
    if written is not None:
        return written
    nets = [*path.parent.glob("*.net.xml"), *path.parent.glob("*.net.xml.gz")]
    if len(nets) == 1:
        return nets[0]
    if nets:
        why = f"there are several nets beside it: {named(sorted(net.name for net in nets))}"
    elif head.net:
        why = f"`{_name(head.net)}`, which it was made with, is not beside it"
    else:
        why = "there is no net beside it"
    raise NET_MISSING.error(
        SourceLocation(str(path)),
        f"SUMO's floating-car data do not say where the roads are, and {why}",
        help="name SUMO's net with --net FILE",
    )


def demand_beside(path: Path, head: FcdHead) -> tuple[Path, ...]:
    """The files beside floating-car data that may describe the types of vehicles."""
    written = [file for name in head.demand if (file := _beside(path, name)) is not None]
    if written:
        return tuple(written)
    only = [*path.parent.glob("*.rou.xml"), *path.parent.glob("*.rou.xml.gz")]
    return tuple(only) if len(only) == 1 else ()


def _beside(path: Path, written: str) -> Path | None:
    # Only the name counts: what a file says shall not lead anywhere else
    candidate = path.parent / _name(written)
    return candidate if candidate.is_file() else None


def _name(written: str) -> str:
    return PurePosixPath(written.replace("\\", "/").replace("\0", "")).name
