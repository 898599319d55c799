"""YAML without its surprises: plain values, text keys, no tags, no more of it than a limit.

Plain values are read by the core schema of YAML 1.2, a little stricter, so that `no` is text and
not false, `1:30` is text and not ninety, `2024-05-01` is text and not a date, `1e3` is a number and
`017` is text; so is a number of more digits than a float holds. A key that is given twice is an
error, and so is a key that is not text. Aliases are counted as if they were written out, since a
few lines of them may stand for billions of values.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Hashable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml
from yaml.constructor import ConstructorError

from objectmodels.errors import ModelError, printable
from objectmodels.files.file_reading import read_text
from objectmodels.files.limits import LIMITS

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
    """A safe loader with its own table of plain values, which counts what it is given."""

    yaml_implicit_resolvers = {}  # noqa: RUF012  (the base class's own kind of attribute)

    def __init__(self, stream: str) -> None:
        super().__init__(stream)
        self._count = self._depth = 0
        self._counts: dict[str | None, int] = {}

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event: Any = self.peek_event()  # type: ignore[no-untyped-call]
        before = self._count
        if isinstance(event, yaml.AliasEvent):
            # One that is not counted yet stands inside itself, or nowhere.
            if event.anchor in self.anchors and event.anchor not in self._counts:
                self._refuse(event, f"the alias *{event.anchor} contains itself")
            self._count += self._counts.get(event.anchor, 0)
        self._count += 1
        self._depth += 1
        if self._count > LIMITS["yaml_nodes"].most:
            self._refuse(event, f"more than {LIMITS['yaml_nodes'].most} values")
        if self._depth > LIMITS["yaml_depth"].most:
            self._refuse(event, f"nested too deeply, more than {LIMITS['yaml_depth'].most} times")
        if isinstance(event, yaml.NodeEvent):
            self._check_node(event)
        node = super().compose_node(parent, index)
        self._depth -= 1
        if isinstance(event, yaml.NodeEvent) and event.anchor is not None:
            self._counts.setdefault(event.anchor, self._count - before)
        return node

    def _check_node(self, event: Any) -> None:
        """Refuses tags, and text that is very long or would steer a terminal."""
        if getattr(event, "tag", None) is not None:
            self._refuse(event, f"the tag {event.tag[:60]} is not read here")
        text = getattr(event, "value", "")
        if len(text) > LIMITS["yaml_text"].most:
            self._refuse(event, f"a text of more than {LIMITS['yaml_text'].most} characters")
        odd = None if text.isprintable() else next((c for c in text if not _is_written(c)), None)
        if odd is not None:
            self._refuse(event, f"the sign U+{ord(odd):04X}, which cannot be printed")

    def _refuse(self, event: Any, problem: str) -> None:
        raise ConstructorError(None, None, problem, event.start_mark)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[str] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, str):
                self._refuse(key_node, f"a key is {kind_text(key)}, not text")
            if key in seen:
                self._refuse(key_node, f"key {key[:60]!r} is given twice")
            seen.add(key)
        return super().construct_mapping(node, deep)


for _tag, _pattern, _first in (
    ("null", r"~|null|", ["~", "n", ""]),
    ("bool", r"true|false", list("tf")),
    ("int", r"[-+]?(0|[1-9][0-9]{0,17})", list("-+0123456789")),
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


def _is_written(sign: str) -> bool:
    """Return True for what people write: signs that can be printed, spaces, ends of lines."""
    return sign.isprintable() or sign in "\n\t" or unicodedata.category(sign) == "Zs"


def parse_yaml(text: str) -> object:
    """Contents of a YAML text.

    Raises:
        ModelError: `bad_yaml`, without a path: it is not YAML, a key is given twice or is not text,
            or it goes beyond a limit.
    """
    try:
        return yaml.load(text, Loader=_Loader)
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise ModelError(
            "bad_yaml",
            f"is not valid YAML here: {_parser_complaint(error)}",
            suggestions=(_hint(error), _EXAMPLES),
        ) from error


def _hint(error: Exception) -> str:
    if isinstance(error, ConstructorError):
        return "take it out of the file"
    return "text with ': ', '#' or a bracket in it needs quotes"


_EXAMPLES = "docs/models.md and docs/scenes.md have files to begin with"


def read_mapping(path: Path, kind: str) -> dict[str, Any]:
    """The mapping that a YAML file holds.

    Args:
        path: the file.
        kind: key of the limit of its size.

    Raises:
        ModelError: `unreadable_file` if it cannot be read, `bad_yaml` if it is not YAML or not a
            mapping of text keys.
    """
    text = read_text(path, kind)
    try:
        content = parse_yaml(text)
    except ModelError as error:
        error.path = printable(str(path))
        raise
    if not isinstance(content, dict):
        raise ModelError(
            "bad_yaml",
            f"holds {kind_text(content)}, expected keys with values",
            path=str(path),
            suggestions=(_EXAMPLES,),
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


def kind_text(content: object) -> str:
    """Kind of a value, in words."""
    return "nothing" if content is None else f"a {type(content).__name__}"
