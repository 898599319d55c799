"""The front: few names, types that can be imported, arguments that are checked, short lines."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import sys
from collections.abc import Callable, Iterator, Mapping
from types import ModuleType
from typing import Any, get_args, get_origin, get_type_hints

import pytest

import nlcontrol
from nlcontrol import AsyncClient, Client, NlcontrolError, Registry, Session
from nlcontrol.types import Check, ControlError, DefaultsError, ParseError, SimError, StatedObject

# Wrong arguments are given on purpose.
# mypy: disable-error-code="arg-type, dict-item"

SUBMODULES = ("types", "frames", "objects", "robots", "views", "batches")
PACKAGES = ("nlcontrol", "grammar", "objectmodels", "planner", "sim")

OPAQUE = {"SimulatedExecutor"}
"""What has many parts of its own that nobody is meant to use."""


@pytest.fixture(scope="module")
def session() -> Session:
    return Session("kitchen")


def public_modules() -> list[ModuleType]:
    return [nlcontrol, *(importlib.import_module(f"nlcontrol.{name}") for name in SUBMODULES)]


def is_own(kind: object) -> bool:
    return isinstance(kind, type) and kind.__module__.partition(".")[0] in PACKAGES


def hints_of(thing: Any) -> Mapping[str, Any]:
    """Type hints, with the names that a module imports for type checkers alone."""
    thing = inspect.unwrap(thing)
    names: dict[str, Any] = {}
    for kind in reversed(getattr(thing, "__mro__", (thing,))):
        module = sys.modules[kind.__module__]
        names |= vars(module)
        if kind.__module__.partition(".")[0] in PACKAGES:
            exec(_imports_for_typing(module), names)
    return get_type_hints(thing, globalns=names, localns=names)


def _imports_for_typing(module: ModuleType) -> str:
    source = inspect.getsource(module).replace("if TYPE_CHECKING:", "if True:")
    lines, kept = source.splitlines(), []
    for number, line in enumerate(lines):
        if line == "if True:":
            for inner in lines[number + 1 :]:
                if inner and not inner.startswith(" "):
                    break
                kept.append(inner[4:])
    return "\n".join(kept)


def classes_in(hint: Any) -> Iterator[type]:
    if get_origin(hint) is not None:
        for part in get_args(hint):
            yield from classes_in(part)
    elif is_own(hint):
        yield hint


def returned_by(kind: type) -> Iterator[type]:
    """Types of the public attributes of a class, and of what its methods return."""
    fields = {f.name for f in dataclasses.fields(kind)} if dataclasses.is_dataclass(kind) else set()
    for base in filter(is_own, kind.__mro__):
        for name, hint in hints_of(base).items():
            if not name.startswith("_") or name in fields:
                yield from classes_in(hint)
    for name, member in inspect.getmembers_static(kind):
        call = getattr(member, "fget", None) or getattr(member, "__func__", member)
        own = inspect.isfunction(call) and call.__module__.partition(".")[0] in PACKAGES
        if own and not name.startswith("_"):
            yield from classes_in(hints_of(call).get("return"))


def test_what_public_calls_return_can_be_imported() -> None:
    public = {id(value) for module in public_modules() for value in vars(module).values()}
    public |= {id(getattr(nlcontrol, name)) for name in nlcontrol.__all__}
    todo = [getattr(nlcontrol, name) for name in nlcontrol.__all__]
    seen, missing = set(), set()
    while todo:
        one = todo.pop()
        if inspect.isfunction(one):
            todo += classes_in(hints_of(one).get("return"))
        elif is_own(one) and one not in seen and one.__name__ not in OPAQUE:
            seen.add(one)
            if id(one) not in public and not one.__name__.startswith("_"):
                missing.add(f"{one.__module__}.{one.__name__}")
            if not issubclass(one, Exception):
                todo += returned_by(one)
    assert len(seen) > 100  # the walk has found something
    assert missing == set()


def test_the_front_has_few_names() -> None:
    assert len(nlcontrol.__all__) <= 16  # some fifteen, and the version


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda s: s.plan(5), "said"),
        (lambda s: s.plan(None), "said"),
        (lambda s: s.plan(b"push the mug"), "said"),
        (lambda s: s.ask(5), "said"),
        (lambda s: s.parse(5), "said"),
        (lambda s: s.start(5), "said"),
        (lambda s: s.start(plan_id=5), "plan_id"),
        (lambda s: s.say("push the mug", motion="maybe"), "motion"),
        (lambda s: s.say("push the mug", on_event=5), "on_event"),
        (lambda s: s.execute(5), "plan"),
        (lambda s: s.look(["mug"]), "objects"),
        (lambda s: s.affordances(None), "name"),
        (lambda s: s.map("mug", spacing="1 cm"), "spacing"),
        (lambda s: s.predict("mug", height=None), "height"),
        (lambda s: s.predict("mug", height=True), "height"),
        (lambda s: s.predict("mug", height=0.05, direction=(1.0, 0.0)), "direction"),
        (lambda s: s.predict("mug", height=0.05, friction="some"), "friction"),
        (lambda _: Session(5), "scene"),
        (lambda _: Session(seed="one"), "seed"),
        (lambda _: Session(seed=-1), "seed"),
        (lambda _: Session(defaults={"push_distance": "far"}), "defaults"),
        (lambda _: Session(executor=5), "executor"),
        (lambda _: Session(approval="yes"), "approval"),
        (lambda _: Client(5), "url"),
        (lambda _: AsyncClient(None), "url"),
        (lambda _: Client("http://127.0.0.1:1").sessions.open(5), "scene"),
        (lambda _: nlcontrol.parse(5), "text"),
        (lambda _: nlcontrol.load_scene(5), "name_or_path"),
        (lambda _: nlcontrol.fit(1, 2), "model"),
        (lambda _: nlcontrol.batch(5), "rows"),
    ],
)
def test_an_argument_of_a_wrong_type_is_refused(
    session: Session, call: Callable[[Session], object], argument: str
) -> None:
    with pytest.raises(NlcontrolError) as raised:
        call(session)
    assert raised.value.code == "bad_arguments"
    assert f"`{argument}`" in raised.value.message
    assert raised.value.suggestions


def test_arguments_of_a_right_type_are_taken(session: Session) -> None:
    import numpy as np

    assert session.predict("ice tea box", height=np.float64(0.05)).outcome == "slide"
    direction = (1, 0, 0)
    assert session.predict("ice tea box", height=0.05, direction=direction).outcome == "slide"
    assert session.plan([{"goal": 5}]).error is not None  # frames have a reader of their own


@pytest.mark.parametrize("kind", [ParseError, SimError, DefaultsError, ControlError])
def test_every_error_has_one_base(kind: type[Exception]) -> None:
    assert issubclass(kind, NlcontrolError)


@pytest.mark.parametrize(
    "call",
    [
        lambda: nlcontrol.parse("blorb the mug"),
        lambda: nlcontrol.load_scene("kitchn"),
        lambda: Registry.default().get("mgu"),
        lambda: Session(defaults={"push_distanc": 0.2}),
        lambda: Session("kitchn"),
        lambda: Client("nowhere"),
    ],
)
def test_one_class_catches_what_is_raised(call: Callable[[], object]) -> None:
    with pytest.raises(NlcontrolError) as raised:
        call()
    error = raised.value
    assert (bool(error.code), bool(error.message), bool(error.suggestions)) == (True, True, True)


def test_everything_is_shown_in_one_short_line(session: Session) -> None:
    client = Client("http://127.0.0.1:1")
    offer = session.plan("push the ice tea box 10 cm away")
    for each in (
        session,
        offer,
        offer.result,
        offer.plan,
        offer.result.guide,
        session.look(),
        session.parse("push the mug"),
        session.predict("ice tea box", height=0.05),
        session.map("ice tea box", spacing=0.05),
        session.affordances("mug"),
        session.plan("push the mug 9 m away").error,
        Registry.default(),
        Registry.default().get("mug"),
        nlcontrol.load_scene("kitchen"),
        client,
        client.sessions,
        client.runs,
        StatedObject(name="mug", x=0.5, y=0.0),
        Check(
            clause="displace",
            quantity="moved in the asked direction",
            relation="about",
            expected=0.1,
            measured=0.0995,
            unit="m",
            verdict="held",
            ok=True,
        ),
    ):
        assert len(repr(each)) <= 120, each
        assert "\n" not in repr(each)
        assert "0x" not in repr(each)
