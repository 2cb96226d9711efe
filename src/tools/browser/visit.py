"""Pages as somebody sees them: on two screens, in light and dark, with all that goes wrong."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Screen:
    """A window: its size in pixels, and whether the reader wants it dark."""

    width: int
    height: int
    theme: str

    def __str__(self) -> str:
        return f"{self.width}-{self.theme}"

    @property
    def settings(self) -> dict[str, Any]:
        """What Playwright calls it."""
        is_phone = self.width < 600
        size = {"width": self.width, "height": self.height}
        touched = {"has_touch": is_phone, "is_mobile": is_phone}
        return {"viewport": size, "color_scheme": self.theme, **touched}


SCREENS = tuple(
    Screen(width, height, theme)
    for width, height in ((1280, 800), (390, 740))
    for theme in ("light", "dark")
)


@dataclass(frozen=True)
class Visit:
    """A page of Playwright's, and what has gone wrong in it so far."""

    page: Any
    screen: Screen
    faults: list[str] = field(default_factory=list)

    def refuse_wide(self) -> None:
        """Count it as a fault if the page is wider than its window."""
        # A phone's own innerWidth grows with what is too wide.
        wide = self.page.evaluate("document.documentElement.scrollWidth")
        if wide > self.screen.width:
            self.faults.append(f"the page is {wide} pixels wide")


@contextmanager
def opened(browser: Any, url: str, screen: Screen = SCREENS[0]) -> Iterator[Visit]:
    """Open a page, in a session of its own.

    Faults are errors of scripts, what the console calls an error, files that are not there, and
    requests to any other host.
    """
    context = browser.new_context(**screen.settings)
    page = context.new_page()
    page.set_default_timeout(30_000)
    visit = Visit(page, screen)
    own = (url[: url.index("/", len("http://")) + 1], "data:", "blob:")

    def look(request: Any) -> None:
        if not request.url.startswith(own):
            visit.faults.append(f"it calls {request.url}")

    context.on("request", look)
    page.on("pageerror", lambda error: visit.faults.append(f"an error: {error}"))
    page.on(
        "console",
        lambda said: visit.faults.append(said.text) if said.type == "error" else None,
    )
    try:
        page.goto(url)
        yield visit
    finally:
        context.close()
