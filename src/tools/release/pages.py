"""Every page of the site in a browser, on two screens, in light and dark."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tools.browser.chromium import PATIENCE_MS, chromium
from tools.browser.links import followed
from tools.browser.served import served
from tools.browser.visit import SCREENS, Screen, opened

_JUDGED = "2 traces: 1 satisfied, 1 violated"
"""What esterle2019 says of the playground's first sample."""


_TALLEST = 4000
"""How much of a long page is on its picture, in pixels."""


def faults_of_site(site: Path, pictures: Path | None) -> Iterator[str]:
    """What goes wrong on the site, each with the page and the screen.

    Pictures of all pages are written into a folder, if there is one. Raises MissingPartError
    without a browser.
    """
    with served(site) as front:
        linked = followed(front)
        yield from (fault.replace(front, "") for fault in linked.faults)
        reached = {page.removeprefix(front) for page in linked.pages}
        there = {path.relative_to(site).as_posix() for path in site.rglob("*.html")}
        yield from (f"{page} cannot be reached" for page in sorted(there - reached))
        with chromium() as browser:
            for page in sorted(there):
                for screen in SCREENS:
                    for fault in _faults(browser, f"{front}{page}", screen, pictures):
                        yield f"{page} at {screen}: {fault.replace(front, '')}"


def _faults(browser: Any, url: str, screen: Screen, pictures: Path | None) -> list[str]:
    with opened(browser, url, screen) as visit:
        try:
            if "/playground/" in url:
                _judge(visit.page)
            elif visit.page.locator("#play").count():
                _play(visit.page)
        except Exception as error:
            visit.faults.append(str(error))
        visit.refuse_wide()
        if pictures is not None:
            name = "-".join(url.split("/")[3:]).removesuffix(".html")
            height = min(visit.page.evaluate("document.documentElement.scrollHeight"), _TALLEST)
            visit.page.set_viewport_size({"width": screen.width, "height": height})
            visit.page.screenshot(path=pictures / f"{name}-{screen}.png")
    return visit.faults


def _judge(page: Any) -> None:
    """Compile the sample of the playground, and judge its traces by a book that ships."""
    page.locator("#state", has_text="Ready").wait_for(timeout=PATIENCE_MS)
    page.get_by_role("tab", name="Traces").click()
    page.get_by_label("Judged by").select_option("esterle2019")
    page.locator("#judge .summary", has_text=_JUDGED).wait_for(timeout=PATIENCE_MS)


def _play(page: Any) -> None:
    """Play a drive from its beginning, until it has gone on."""
    page.locator("#slider").fill("0")
    begins = page.locator("#time").inner_text()
    page.locator("#play").click()
    page.locator("#time").filter(has_not_text=begins).wait_for()
    page.locator("#play").click()
