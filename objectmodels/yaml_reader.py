"""Reading a YAML file without the surprises of YAML 1.1.

Plain values are read by the core schema of YAML 1.2, a little stricter: `no` is text and not
false, `1:30` is text and not ninety, `2024-05-01` is text and not a date, `1e3` is a number and
`017` is text. A key that is given twice is an error, and so is a key that is not text.
"""

from __future__ import annotations

import re
from collections.abc import Hashable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from objectmodels.errors import ModelError

MAX_BYTES = 1_000_000
"""Larger files are not model files."""


if TYPE_CHECKING or not yaml.__with_libyaml__:
    _Parser = yaml.SafeLoader
else:
    from yaml.composer import Composer
    from yaml.constructor import SafeConstructor
    from yaml.cyaml import CParser
    from yaml.resolver import Resolver

    class _Parser(Composer, CParser, SafeConstructor, Resolver):
        """libyaml's parser, ten times as fast, below the composer in Python.

        libyaml's own composer overflows the stack where text is nested too deeply.
        """

        def __init__(self, stream: str) -> None:
            CParser.__init__(self, stream)
            Composer.__init__(self)
            SafeConstructor.__init__(self)
            Resolver.__init__(self)


class _Loader(_Parser):
    """A safe loader with its own table of plain values."""

    yaml_implicit_resolvers = {}  # noqa: RUF012  (the base class's own kind of attribute)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[str] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            line = key_node.start_mark.line + 1
            if not isinstance(key, str):
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {key!r} in line {line} is not text", key_node.start_mark
                )
            if key in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {key!r} is given twice (line {line})", key_node.start_mark
                )
            seen.add(key)
        return super().construct_mapping(node, deep)


for _tag, _pattern, _first in (
    ("null", r"~|null|", ["~", "n", ""]),
    ("bool", r"true|false", list("tf")),
    ("int", r"[-+]?(0|[1-9][0-9]*)", list("-+0123456789")),
    (
        "float",
        r"[-+]?([0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eE]))([eE][-+]?[0-9]+)?"
        r"|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
        list("-+.0123456789"),
    ),
):
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_tag}", re.compile(f"^({_pattern})$"), _first
    )


def parse_yaml(text: str) -> object:
    """Contents of a YAML text.

    Raises:
        yaml.YAMLError: it is not YAML, or a key is given twice or is not text.
    """
    return yaml.load(text, Loader=_Loader)


def read_yaml(path: Path) -> dict[str, Any]:
    """The mapping that a YAML file holds.

    Args:
        path: the file.

    Raises:
        ModelError: `unreadable_file` if it cannot be read, `bad_yaml` if it is not YAML or not a
            mapping of text keys.
    """
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise ModelError(
                "unreadable_file",
                f"is {size} bytes long, expected at most {MAX_BYTES}",
                path=str(path),
            )
        data = path.read_bytes()
        content = parse_yaml(data.decode("utf-8"))
    except OSError as error:
        raise ModelError(
            "unreadable_file", f"cannot be read: {error.strerror}", path=str(path)
        ) from error
    except (UnicodeDecodeError, yaml.YAMLError, RecursionError) as error:
        raise ModelError(
            "bad_yaml", f"is not valid YAML: {_parser_complaint(error)}", path=str(path)
        ) from error
    if not isinstance(content, dict):
        raise ModelError(
            "bad_yaml", f"holds {_node_kind(content)}, expected keys with values", path=str(path)
        )
    return content


def _parser_complaint(error: Exception) -> str:
    """The parser's complaint in one line."""
    if isinstance(error, yaml.MarkedYAMLError) and error.problem:
        mark = error.problem_mark
        where = f" (line {mark.line + 1}, column {mark.column + 1})" if mark else ""
        return error.problem + where
    if isinstance(error, RecursionError):
        return "nested too deeply"
    return " ".join(str(error).split())


def _node_kind(content: object) -> str:
    return "nothing" if content is None else f"a {type(content).__name__}"
