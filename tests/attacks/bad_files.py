"""Generated files: good ones with something wrong in them, odd YAML, odd numbers and names."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import yaml
from hypothesis import strategies as st

ROOT = Path(__file__).parents[2]

ODD_NUMBERS = [
    0, -0.0, -1, 1, 1e-300, 5e-324, 1e-12, 1e-6, 0.1, 1e6, 1e15, 1e300, 1.7e308, -1e300, 10**18,
    10**400, float("inf"), float("-inf"), float("nan"),
]  # fmt: skip
ODD_NAMES = [
    "", " ", "a ", "\x1b[31mred", "a\0b", "a\u202eb", "a\ud800", "x" * 101, "x" * 20_000, "../x",
    "no", "1:30", "017", "\u200b", "é", "箱", "a\nb", "*a", "&a", "!!int", "<<", "=", "-", "~", "{",
]  # fmt: skip
SPLICES = [
    "!!int abc", "!!float 1:x", "!!timestamp 2001-99-99", "!!bool maybe", "!!python/object:os {}",
    "!!binary x", "!!set {a}", "&a [*a]", "&a {b: *a}", "*a", "&a", "<<: *a", "? [x]\n: y", "---\n",
    "...\n", "%YAML 3.0\n", "\t", "\x00", "\x1b[2J", "\ufeff", "\u2028", "9" * 5000, "1e999999",
    "a: &a [x,x,x,x,x,x,x,x,x]\nb: &b [*a,*a,*a,*a,*a,*a,*a,*a,*a]\nc: [*b,*b,*b,*b,*b,*b,*b,*b]\n",
    "[" * 3000, "{a: " * 3000, "- " * 3000, "'", '"', "|", ">", "# ", ": ", ",", "\r", "\\",
]  # fmt: skip

numbers = st.sampled_from(ODD_NUMBERS) | st.floats() | st.integers()
names = st.sampled_from(ODD_NAMES) | st.text(max_size=20)
odd_values: st.SearchStrategy[Any] = st.recursive(
    st.none() | st.booleans() | numbers | names,
    lambda inner: st.lists(inner, max_size=5) | st.dictionaries(names, inner, max_size=3),
    max_leaves=6,
)


@cache
def documents(folder: str) -> list[Any]:
    """The contents of the good files of a folder."""
    return [yaml.safe_load(path.read_text("utf-8")) for path in (ROOT / folder).glob("*.yaml")]


def places(document: Any) -> list[tuple[Any, Any]]:
    """Every mapping or list of a document, with each of its keys."""
    if not isinstance(document, dict | list):
        return []
    keys = list(document) if isinstance(document, dict) else list(range(len(document)))
    return [(document, k) for k in keys] + [place for k in keys for place in places(document[k])]


def mutated_documents(folder: str) -> st.SearchStrategy[bytes]:
    """A good document of a folder of which some values are odd, missing or new, as YAML."""
    return mutated(documents(folder)).map(
        lambda document: _text(document).encode("utf-8", "surrogatepass")
    )


@st.composite
def mutated(draw: st.DrawFn, good: list[Any]) -> Any:
    """One of some good documents of which some values are odd, some are missing, some are new."""
    document = json.loads(json.dumps(draw(st.sampled_from(good))))
    for _ in range(draw(st.integers(1, 3))):
        holder, key = draw(st.sampled_from(places(document)))
        change = draw(st.sampled_from(["value", "number", "number", "scale", "remove", "add"]))
        if change == "value":
            holder[key] = draw(odd_values)
        elif change == "number":
            holder[key] = draw(numbers)
        elif change == "scale" and isinstance(holder[key], int | float):
            # An integer of hundreds of digits has no product with a float.
            if abs(holder[key]) < 1e300:
                holder[key] *= draw(st.sampled_from([-1, 1e-9, 1e-3, 1e3, 1e9]))
        elif change == "remove":
            del holder[key]
        elif isinstance(holder, dict):
            holder[draw(names)] = draw(odd_values)
        else:
            holder.extend([draw(numbers)] * draw(st.integers(1, 3000)))
        if not places(document):
            break
    return document


def _text(document: Any) -> str:
    """A document as YAML; what its writer refuses, as JSON, which is YAML as well."""
    try:
        return yaml.safe_dump(document, allow_unicode=True)
    except (yaml.YAMLError, ValueError):
        return json.dumps(document)


@st.composite
def spliced(draw: st.DrawFn, good: list[bytes], splices: list[str]) -> bytes:
    """A good file with pieces cut out, doubled, or put in."""
    data = draw(st.sampled_from(good))
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(data)))
        until = min(len(data), at + draw(st.integers(0, 40)))
        piece = draw(st.sampled_from(splices).map(_encode) | st.binary(max_size=8))
        kind = draw(st.sampled_from(["insert", "replace", "double", "cut"]))
        if kind == "insert":
            data = data[:at] + piece + data[at:]
        elif kind == "replace":
            data = data[:at] + piece + data[until:]
        elif kind == "double":
            data = data[:until] + data[at:]
        else:
            data = data[:at] + data[until:]
    return data


def _encode(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass")


def good_bytes(pattern: str) -> list[bytes]:
    """Good files of the repository."""
    return [path.read_bytes() for path in sorted(ROOT.glob(pattern))]


def yaml_files(folder: str) -> st.SearchStrategy[bytes]:
    """Files of which a few are good."""
    return (
        mutated_documents(folder)
        | spliced(good_bytes(f"{folder}/*.yaml"), SPLICES)
        | odd_values.map(_text).map(_encode)
        | st.binary(max_size=200)
    )
