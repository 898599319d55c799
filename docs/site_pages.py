"""Pages of the site that stand beside `docs/`, and links that lead to them.

A hook of MkDocs. A guide links to `../CONTRIBUTING.md` and CONTRIBUTING.md to `docs/json.md`, as
both do for who reads them as files. In the site there is no folder `docs`.
"""

from __future__ import annotations

import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds the pages of the project's folder, and the examples."""
    examples = (path for path in sorted(Path("examples").rglob("*.*")) if path.suffix != ".pyc")
    for path in (*map(Path, PAGES), *examples):
        content = (ROOT / path).read_bytes()
        files.append(File.generated(config, path.as_posix(), content=content))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turns links as they hold between files into those between pages."""
    path = page.file.src_uri
    if path in PAGES:
        return re.sub(r"\]\(docs/", "](", markdown)
    up = "../" * path.count("/")
    return re.sub(rf"\]\({re.escape(up)}\.\./(?!\.)", f"]({up}", markdown)
