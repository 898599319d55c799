"""YAML without its surprises: plain values, text keys, no tags, no more of it than a limit.

Plain values are read by the core schema of YAML 1.2, a little stricter, so that `no` is text and
not false, `1:30` is text and not ninety, `2024-05-01` is text and not a date, `1e3` is a number and
`017` is text; so is a number of more digits than a float holds. A key that is given twice is an
error, and so is a key that is not text. Aliases are counted as if they were written out, since a
few lines of them may stand for billions of values.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import re
import reprlib
import stat
import tempfile
import time
import unicodedata
from collections.abc import Hashable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, get_args

import yaml
from pydantic import AfterValidator, BaseModel, Field, ValidationError
from yaml.constructor import ConstructorError

from objectmodels.errors import ModelError, printable, suggest

# Limits of what comes from outside: sizes of files, counts and ranges of numbers.
#
# The one table of them; docs/limits.md shows it, and a test holds the two together. Ranges of
# numbers are wide: they keep out what is no object on a table, and what formulae would overflow
# with.


class Limit(NamedTuple):
    """A range, its ends included.

    Attributes:
        what: is limited.
        least, most: its ends.
        unit: of both.
    """

    what: str
    least: float
    most: float
    unit: str


LIMITS: Mapping[str, Limit] = MappingProxyType(
    {
        "model_file": Limit("model file", 0, 1_000_000, "bytes"),
        "scene_file": Limit("scene file", 0, 1_000_000, "bytes"),
        "data_file": Limit("data file (CSV)", 0, 50_000_000, "bytes"),
        "mesh_file": Limit("mesh file, also unpacked", 0, 60_000_000, "bytes"),
        "description_file": Limit("description (URDF, SDF, MJCF)", 0, 10_000_000, "bytes"),
        "record_file": Limit("record of experiments", 0, 200_000_000, "bytes"),
        "trace_file": Limit("file of a trace, also unpacked", 0, 500_000_000, "bytes"),
        "bundle_file": Limit("bundle of a run", 0, 200_000_000, "bytes"),
        "bundle_part": Limit("member of a bundle, unpacked", 0, 200_000_000, "bytes"),
        "history_file": Limit("history of the shell", 0, 10_000_000, "bytes"),
        "token_file": Limit("file of a token", 0, 10_000, "bytes"),
        "frames_file": Limit("file of frames", 0, 1_000_000, "bytes"),
        "batch_row": Limit("row of a batch", 0, 1_000_000, "bytes"),
        "lexicon_file": Limit("file of words of a plug-in", 0, 1_000_000, "bytes"),
        "yaml_nodes": Limit("values in a YAML file, aliases written out", 0, 20_000, ""),
        "yaml_depth": Limit("lists and mappings inside each other", 0, 20, ""),
        "yaml_text": Limit("one text in a YAML file", 0, 10_000, "characters"),
        "data_rows": Limit("lines of a data file", 0, 200_000, ""),
        "data_columns": Limit("columns of a data file", 1, 100, ""),
        "mesh_triangles": Limit("triangles of a mesh", 1, 1_200_000, ""),
        "name": Limit("name of an object, a model or a scene", 1, 100, "characters"),
        "objects": Limit("objects in a scene", 0, 60, ""),
        "corners": Limit("corners of a base", 3, 2000, ""),
        "support": Limit("points of a support", 3, 500, ""),
        "vertices": Limit("vertices of a hull", 4, 2000, ""),
        "mass": Limit("mass", 1e-6, 1e4, "kg"),
        "length": Limit("length, radius, height", 1e-6, 100.0, "m"),
        "table": Limit("size of a table", 0.001, 10.0, "m"),
        "variation": Limit("length over which friction varies", 0.02, 100.0, "m"),
        "height": Limit("height on an object", 0.0, 100.0, "m"),
        "coordinate": Limit("coordinate", -100.0, 100.0, "m"),
        "friction": Limit("friction coefficient", 1e-12, 100.0, ""),
        "deviation": Limit("standard deviation", 0.0, 1e4, "unit of the value"),
        "weight": Limit("weight of a support point", 1e-4, 1e4, ""),
        "volume": Limit("contents", 0.0, 1e4, "l"),
        "density": Limit("density", 1e-3, 1e5, "kg/m³"),
        "force": Limit("force", 0.0, 1e6, "N"),
        "squeeze": Limit("squeeze that crushes", 1e-3, 1e6, "N"),
        "torque": Limit("torque", 0.0, 1e6, "N·m"),
        "turns": Limit("turns of a cap", 1e-3, 100.0, ""),
        "angle": Limit("angle", -3600.0, 3600.0, "degrees"),
        "opening": Limit("opening of a lid", 1e-3, 360.0, "degrees"),
        "frames": Limit("frames of a camera", 0.1, 1000.0, "Hz"),
        "samples": Limit("samples of a torque sensor", 1.0, 1e5, "Hz"),
        "time_step": Limit("time step of the simulation", 1e-4, 0.005, "s"),
        "control_rate": Limit("control rate", 20.0, 1000.0, "Hz"),
        "delay": Limit("delay of a camera", 0.0, 10.0, "s"),
    }
)
"""Every limit by its key."""


# Reading of files that others made: regular files alone, and no more of them than a limit.
#
# What may be wrong with a file, whatever its bytes, ends in a `ModelError` with the file, what
# was found, what was expected and what to do.

_HINTS = {
    errno.ENOENT: "check the path; it begins at the folder that you are in",
    errno.EISDIR: "give the path of a plain file",
    errno.ENOTDIR: "check the path; a part of it is a file and no folder",
    errno.EACCES: "change its permissions, or choose another place",
    errno.EPERM: "change its permissions, or choose another place",
    errno.EROFS: "choose a place on a disk that can be written to",
    errno.ENOSPC: "free some space on the disk, or choose another one",
    errno.EDQUOT: "free some space on the disk, or choose another one",
    errno.EFBIG: "choose a disk that takes files of this size",
    errno.ENAMETOOLONG: "choose a shorter name",
}


def error_of_system(code: str, what: str, path: Path, error: OSError | ValueError) -> ModelError:
    """An error of the system about a file, with a hint.

    Args:
        code: of the error.
        what: failed, like "cannot be read".
        path: of the file.
        error: that the system raised; a `ValueError` for a path that cannot be one.
    """
    number = error.errno if isinstance(error, OSError) else None
    reason = os.strerror(number) if number else str(error)
    hint = _HINTS.get(number or 0, "choose another file")
    return ModelError(code, f"{what}: {reason}", path=str(path), suggestions=(hint,))


def read_bytes(path: Path, kind: str) -> bytes:
    """Contents of a file from outside.

    Args:
        path: of a regular file, or a link to one.
        kind: key of the limit of its size.

    Raises:
        ModelError: `unreadable_file`.
    """
    limit = LIMITS[kind]
    most = int(limit.most)
    try:
        with open(path, "rb", opener=_open_at_once) as file:
            regular = stat.S_ISREG(os.fstat(file.fileno()).st_mode)
            content = file.read(most + 1) if regular else b""
    except (OSError, ValueError) as error:
        raise error_of_system("unreadable_file", "cannot be read", path, error) from error
    if not regular:
        raise ModelError(
            "unreadable_file",
            f"is a device or a pipe, expected a {limit.what}",
            path=str(path),
            suggestions=("give the path of a plain file",),
        )
    if len(content) > most:
        raise ModelError(
            "unreadable_file",
            f"is too large, expected a {limit.what} of at most {most} bytes",
            path=str(path),
            suggestions=("check that this is the file you mean", "leave out what is not needed"),
        )
    return content


def _open_at_once(path: str, flags: int) -> int:
    """Opens a file, and does not wait for the writer of a pipe."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def read_text(path: Path, kind: str) -> str:
    """Text of a file from outside, in UTF-8; see `read_bytes`."""
    try:
        return read_bytes(path, kind).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ModelError(
            "unreadable_file",
            f"is no text in UTF-8: byte {error.start + 1} is 0x{error.object[error.start]:02x}",
            path=str(path),
            suggestions=("save it in UTF-8",),
        ) from error


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
            # No tags, and no text that is very long or would steer a terminal.
            tag, text = getattr(event, "tag", None), getattr(event, "value", "")
            if tag is not None:
                self._refuse(event, f"the tag {tag[:60]} is not read here")
            if len(text) > LIMITS["yaml_text"].most:
                self._refuse(event, f"a text of more than {LIMITS['yaml_text'].most} characters")
            odd = (
                None if text.isprintable() else next((c for c in text if not _is_written(c)), None)
            )
            if odd is not None:
                self._refuse(event, f"the sign U+{ord(odd):04X}, which cannot be printed")
        node = super().compose_node(parent, index)
        self._depth -= 1
        if isinstance(event, yaml.NodeEvent) and event.anchor is not None:
            self._counts.setdefault(event.anchor, self._count - before)
        return node

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
        hint = "text with ': ', '#' or a bracket in it needs quotes"
        if isinstance(error, ConstructorError):
            hint = "take it out of the file"
        raise ModelError(
            "bad_yaml",
            f"is not valid YAML here: {_parser_complaint(error)}",
            suggestions=(hint, _EXAMPLES),
        ) from error


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


PREFIX = ".nlcontrol-"
"""Beginning of the names of temporary files."""

_PATIENCE, _PAUSE = 60.0, 0.02  # waiting for another process that changes the same folder [s]


@contextlib.contextmanager
def replace_file(path: Path, *, private: bool = False) -> Iterator[Path]:
    """A temporary file beside `path` that takes its place when all went well; makes its folder.

    So nobody ever reads half a file, and a failure leaves an older one as it was. What a process
    that was killed left there is removed by a later one.

    Args:
        path: of the file.
        private: whether nobody else may read it.

    Raises:
        ModelError: `cannot_write`.
    """
    if os.path.lexists(path) and not os.path.isfile(path):
        raise ModelError(
            "cannot_write",
            "is a folder or a device",
            path=str(path),
            suggestions=("give the path of a plain file",),
        )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        for left in path.parent.glob(f"{PREFIX}*"):
            with contextlib.suppress(OSError):
                # Age from which on nobody writes a temporary file any more [s].
                if time.time() - left.stat().st_mtime > 600.0:
                    left.unlink()
        handle, name = tempfile.mkstemp(prefix=PREFIX, suffix=path.suffix, dir=path.parent)
        os.close(handle)
        temporary = Path(name)
        try:
            yield temporary
            # mkstemp lets nobody else read the file; give it what a plain `open` would have.
            umask = os.umask(0)
            os.umask(umask)
            temporary.chmod(0o600 if private else 0o666 & ~umask)
            _sync(temporary)
            temporary.replace(path)
            _sync(path.parent)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise error_of_system("cannot_write", "cannot be written", path, error) from error


def remove_file(path: Path) -> None:
    """Removes a file for good.

    Raises:
        ModelError: `cannot_write`.
    """
    try:
        path.unlink()
        _sync(path.parent)
    except OSError as error:
        raise error_of_system("cannot_write", "cannot be removed", path, error) from error


@contextlib.contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Keeps other processes that ask for the same lock out of a folder; it is made if need be.

    Raises:
        ModelError: `cannot_write` if it cannot be made, or another one does not let go of it.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise error_of_system("cannot_write", "cannot be written to", folder, error) from error
    try:
        end = time.monotonic() + _PATIENCE
        while not _try_lock(handle):
            if time.monotonic() > end:
                raise ModelError(
                    "cannot_write",
                    f"another process has been changing this folder for {_PATIENCE:g} s",
                    path=str(folder),
                    suggestions=("try again when it is done",),
                )
            time.sleep(_PAUSE)
        yield
    finally:
        os.close(handle)  # which lets go of the lock, as the end of the process would


def _try_lock(handle: int) -> bool:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _sync(path: Path) -> None:
    """Waits until a file, or the entries of a folder, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


_LONGEST = 80

_short = reprlib.Repr()
_short.maxstring = _short.maxother = _LONGEST

_KEYS_HINT = "docs/models.md and docs/scenes.md explain the keys"
_RANGES_HINT = "docs/limits.md has the ranges"


class Fault(NamedTuple):
    """A fault of a file.

    Attributes:
        code: `missing_key`, `unknown_key` or `bad_value`.
        key: where it is, with dots between the keys.
        message: what was found and what was expected.
        suggestions: what would be right.
    """

    code: str
    key: str
    message: str
    suggestions: tuple[str, ...]

    def error(self, place: str) -> ModelError:
        """The fault as an error of the file or the call that `place` names."""
        where = f"{place}: {self.key}"
        return ModelError(self.code, self.message, path=where, suggestions=self.suggestions)


def first_fault(error: ValidationError, cls: type[BaseModel]) -> Fault:
    """The complaint that helps most.

    Args:
        error: of a document that was validated.
        cls: as which it was.
    """
    # A key that is unknown is often the one that is missing, misspelt.
    complaints = error.errors(include_url=False)
    first = min(complaints, key=lambda e: e["type"] != "extra_forbidden")
    key = printable(".".join(map(str, first["loc"]))) or "file"
    if first["type"] == "missing":
        hint = f"add `{key.rpartition('.')[2]}: …`"
        return Fault("missing_key", key, "is required, but not given", (hint, _KEYS_HINT))
    if first["type"] == "extra_forbidden":
        wrong, known = key.rpartition(".")[2], sorted(_all_keys(cls))
        near = suggest(wrong, known) or [name for name in known if name.startswith(wrong + "_")]
        hints = tuple(f"did you mean '{name}'?" for name in near[:1])
        return Fault(
            "unknown_key",
            key,
            "is not a key of this format",
            hints or (f"known: {', '.join(file_keys(cls))}" if "." not in key else _KEYS_HINT,),
        )
    return _value_fault(first, key, cls)


def _value_fault(complaint: Any, key: str, cls: type[BaseModel]) -> Fault:
    inner = complaint.get("ctx", {}).get("error")
    expected = re.sub(r"^(Value error, |Input should be |\w+ should have )", "", complaint["msg"])
    hints = tuple(getattr(inner, "suggestions", ()))
    if isinstance(inner, ModelError):
        expected = inner.message
        if inner.path is not None:
            # The place in a file has the field's key in place of its name.
            name, dot, rest = inner.path.partition(".")
            field = cls.model_fields.get(name)
            return Fault(
                "bad_value",
                (field.alias if field and field.alias else name) + dot + rest,
                expected,
                hints or (_KEYS_HINT,),
            )
    ranges = complaint["type"].startswith(("less_", "greater_", "too_", "string_too_", "finite_"))
    hints = hints or (_RANGES_HINT if ranges else _KEYS_HINT,)
    if complaint["loc"] and not isinstance(complaint["input"], dict):
        expected = f"found {short_text(complaint['input'])}, expected {expected}"
    return Fault("bad_value", key, expected, hints)


def file_keys(cls: type[BaseModel]) -> list[str]:
    """Keys of a class in a file."""
    return [field.alias or name for name, field in cls.model_fields.items() if name != "kind"]


def _all_keys(cls: type[BaseModel]) -> set[str]:
    """Keys of a class in a file, and those of the blocks in it."""
    found = set(file_keys(cls))
    for field in cls.model_fields.values():
        for part in classes_in(field.annotation):
            found |= _all_keys(part)
    return found


def classes_in(annotation: Any) -> list[type[BaseModel]]:
    """Models of pydantic that a type is made of."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [part for argument in get_args(annotation) for part in classes_in(argument)]


def short_text(value: object) -> str:
    """A value as it would be written in Python, cut if it is long."""
    text = _short.repr(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def range_of(key: str) -> Any:
    """The field of a number within a limit."""
    limit = LIMITS[key]
    return Field(ge=limit.least, le=limit.most)


def length_of(key: str) -> Any:
    """The field of a text or a sequence whose length is within a limit."""
    limit = LIMITS[key]
    return Field(min_length=int(limit.least), max_length=int(limit.most))


# Characters that show nothing, or change how others are shown: controls, formats, white space.
_UNSEEN = (
    r"\x00-\x1f\x7f-\xa0\xad\u0600-\u0605\u061c\u06dd\u070f\u0890\u0891\u08e2\u1680\u180e"
    r"\u2000-\u200f\u2028-\u202f\u205f-\u206f\u3000\ufeff\ufff9-\ufffb"
    "\U000110bd\U000110cd\U00013430-\U0001343f\U0001bca0-\U0001bca3\U0001d173-\U0001d17a"
    "\U000e0000-\U000e007f"
)

NAME = f"^[^- {_UNSEEN}]([^{_UNSEEN}]*[^ {_UNSEEN}])?$"
"""Pattern of a name, in Python as in JSON Schema."""


def _written_name(text: str) -> str:
    if text.startswith("-"):
        raise ValueError("a name that does not begin with a dash, as options of commands do")
    if re.fullmatch(NAME, text) is None:
        raise ValueError("signs that can be printed, without white space at the ends")
    return text


Name = Annotated[
    str,
    Field(json_schema_extra={"pattern": NAME}),
    length_of("name"),
    AfterValidator(_written_name),
]
"""Name or synonym of an object, a model or a scene."""

Mass = Annotated[float, range_of("mass")]
Length = Annotated[float, range_of("length")]
TableLength = Annotated[float, range_of("table")]
Height = Annotated[float, range_of("height")]
Coordinate = Annotated[float, range_of("coordinate")]
Friction = Annotated[float, range_of("friction")]
Deviation = Annotated[float, range_of("deviation")]
Weight = Annotated[float, range_of("weight")]
Volume = Annotated[float, range_of("volume")]
Density = Annotated[float, range_of("density")]
Force = Annotated[float, range_of("force")]
Squeeze = Annotated[float, range_of("squeeze")]
Torque = Annotated[float, range_of("torque")]
Turns = Annotated[float, range_of("turns")]
Angle = Annotated[float, range_of("angle")]
OpeningAngle = Annotated[float, range_of("opening")]
