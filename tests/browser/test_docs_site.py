"""The site of the guides: built without a warning, whole, and asking nothing of other addresses."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser

ROOT = Path(__file__).parents[2]
LARGEST = 20e6
"""Size of the site [bytes]."""

pytestmark = pytest.mark.slow


class Links(HTMLParser):
    """Anchors of a page, what it links to, and what it loads by itself."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.ids: set[str] = {""}
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" or (tag == "a" and name == "name"):
                self.ids.add(value or "")
            elif name == "href" and tag == "a":
                self.links.append(value or "")
            elif name in ("src", "href"):
                self.loaded.append(value or "")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if importlib.util.find_spec("mkdocs") is None:
        pytest.skip("MkDocs is not installed: pip install '.[docs]'")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "-d", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder


def test_every_link_and_anchor_inside_the_site_leads_somewhere(site: Path) -> None:
    pages = {page: Links(page) for page in site.rglob("*.html")}
    assert len(pages) > 35
    lost = []
    for page, found in pages.items():
        if page.name == "404.html":  # whose links are those of a server's root
            continue
        for link in (*found.links, *found.loaded):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            to = (page.parent / unquote(parts.path)).resolve() if parts.path else page
            if not to.is_file() or (to in pages and unquote(parts.fragment) not in pages[to].ids):
                lost.append((page.name, link))
    assert not lost


def test_nothing_is_loaded_from_elsewhere(site: Path) -> None:
    for page in site.rglob("*.html"):
        assert [at for at in Links(page).loaded if urlsplit(at).netloc] == [], page
    for style in site.rglob("*.css"):
        assert not re.search(r"(?:url\(|@import)\s*[\"']?https?:", style.read_text("utf-8"))
    assert sum(path.stat().st_size for path in site.rglob("*") if path.is_file()) < LARGEST


def test_the_search_works_in_a_page_that_is_opened_from_its_file(
    site: Path, browser: Browser
) -> None:
    page = browser.new_page(offline=True)
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto((site / "index.html").as_uri())
    box = page.locator("input[data-md-component=search-query]")
    box.click()
    page.get_by_text("Type to start searching").wait_for()
    box.press_sequentially("crush_n")  # the page listens to keys
    page.wait_for_selector(".md-search-result__item", state="attached")
    first = page.locator(".md-search-result__link").first
    assert "models.html" in (first.get_attribute("href") or "")
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:", "about:"))] == []
    page.close()
