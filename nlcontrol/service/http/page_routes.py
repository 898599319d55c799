"""Routes of the pages for people: files from a fixed table, made once.

No path of a request reaches the file system. The page holds nothing of a run or of a person; all
that it shows it asks for by the routes of the service. At `/docs` is the OpenAPI document, drawn by
Swagger UI, whose files the package fastapi-offline brings.
"""

from __future__ import annotations

import gzip
import hashlib
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from types import MappingProxyType
from typing import NamedTuple

from fastapi import APIRouter, HTTPException, Request
from starlette.responses import Response

PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "require-trusted-types-for 'script'; trusted-types 'none'"
)
"""Content security policy of the page: its own files, and no text that becomes a script."""

ROUTER = APIRouter(include_in_schema=False)

_MEDIA_TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css"}
_LIBRARY = ("swagger-ui.css", "swagger-ui-bundle.js")  # of fastapi-offline
_OF_REPLAY_FILES = "replay"  # what these begin with is of files that replay, and not of the page


class PageFile(NamedTuple):
    """A file of the page.

    Attributes:
        content: content of the file.
        packed: the same, compressed (gzip).
        media_type: media type of the file.
        tag: entity tag, by which a browser knows that it has this content already.
    """

    content: bytes
    packed: bytes
    media_type: str
    tag: str


@cache
def page_files() -> Mapping[str, PageFile]:
    """The files of the pages, of their viewer and of their library, by their addresses."""
    page = resources.files("nlcontrol.service") / "page"
    viewer = resources.files("sim.views") / "page"
    found = dict([*_files_below(page, "/page/"), *_files_below(viewer, "/viewer/")])
    pages = {"/": found.pop("/page/index.html"), "/docs": found.pop("/page/docs/docs.html")}
    library = resources.files("fastapi_offline") / "static"
    library_files = {f"/docs/library/{name}": _page_file(library / name) for name in _LIBRARY}
    return MappingProxyType({**pages, **found, **library_files})


def _files_below(folder: Traversable, address: str) -> Iterator[tuple[str, PageFile]]:
    for item in folder.iterdir():
        if item.is_dir():
            yield from _files_below(item, f"{address}{item.name}/")
        elif _media_type(item) is not None and not item.name.startswith(_OF_REPLAY_FILES):
            yield address + item.name, _page_file(item)


def _page_file(item: Traversable) -> PageFile:
    content = item.read_bytes()
    tag = f'W/"{hashlib.sha256(content).hexdigest()[:32]}"'
    packed = gzip.compress(content, mtime=0)
    return PageFile(content, packed, f"{_media_type(item)}; charset=utf-8", tag)


def _media_type(item: Traversable) -> str | None:
    return _MEDIA_TYPES.get(f".{item.name.rpartition('.')[2]}")


@ROUTER.get("/")
@ROUTER.get("/docs")
@ROUTER.get("/docs/{rest:path}")
@ROUTER.get("/page/{rest:path}")
@ROUTER.get("/viewer/{rest:path}")
def read_page_file(request: Request) -> Response:
    """Sends a file of the page, unless the browser has it."""
    file = page_files().get(request.url.path)
    if file is None:
        raise HTTPException(404)
    headers = {
        "Cache-Control": "no-cache",
        "Content-Security-Policy": PAGE_POLICY,
        "Cross-Origin-Opener-Policy": "same-origin",
        "ETag": file.tag,
        "Vary": "Accept-Encoding",
    }
    if request.headers.get("if-none-match") == file.tag:
        return Response(status_code=304, headers=headers)
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return Response(file.content, headers=headers, media_type=file.media_type)
    headers["Content-Encoding"] = "gzip"
    return Response(file.packed, headers=headers, media_type=file.media_type)
