"""Questions to the service and its answers, as documents: tables, sessions, plans to approve, runs.

All numbers are in SI units, places in W. The result of a sentence is a
`nlcontrol.results.result.Result`, whichever way it comes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, StrictBool, ValidationError

from grammar.frames.command import Command, Frame, Spans
from nlcontrol.errors import ControlError, ErrorInfo, error
from nlcontrol.json_document import Document, DocumentPart
from nlcontrol.results.result import Result, ResultStatus
from nlcontrol.session.events import Event
from objectmodels.files.yaml_documents import LIMITS, Coordinate, Name, length_of
from planner.affordances import Affordance
from planner.plan_explanation import Row
from planner.types.plan import Plan
from planner.types.world_state import Mark
from sim.views.run_story import ContactMark, Ghost, StoryLine

Source = Literal["camera", "stated"]
RunKind = Literal["execute", "say", "unknown"]
RunState = Literal["queued", "running", "ended", "aborted", "cut_off", "defect", "unreadable"]


_LONGEST_PATH = 4096


def _number(value: Any) -> Any:
    """A number of JSON; what says true, or has digits in quotation marks, is none."""
    if isinstance(value, bool | str):
        raise ValueError("a number")
    return value


IsNumber = BeforeValidator(_number)
Number = Annotated[float, IsNumber]
ShortText = Annotated[str, Field(max_length=int(LIMITS["name"].most))]
"""Name that a caller gives, no longer than those in files."""


class StatedObject(DocumentPart):
    """An object, and where a caller's own camera says that it stands.

    Attributes:
        name: unique name on this table.
        model: name of the registry's model; the object's name if not given.
        x, y: position of B's origin in W [m].
        yaw: heading of B's x axis, counter-clockwise from W's [rad].
        synonyms: further names on this table.
        fragile: hand and other objects keep well away from it.
        fixed: a holder keeps it where it stands.
    """

    name: Name
    model: Name | None = None
    x: Annotated[Coordinate, IsNumber]
    y: Annotated[Coordinate, IsNumber]
    yaw: Annotated[Coordinate, IsNumber] = 0.0
    synonyms: tuple[Name, ...] = Field(default=(), max_length=20)
    fragile: StrictBool = False
    fixed: StrictBool = False


StatedObjects = Annotated[tuple[StatedObject, ...], length_of("objects")]


class TableSpec(DocumentPart):
    """A table to plan for: that of a simulated scene, or one that the caller states.

    Attributes:
        scene: name of a scene of the host. Where objects are stated, its mount, table top and
            sensors count, and its own objects do not.
        seed: seed of all randomness; the same seed gives the same trace.
        defaults: what a clause means when a sentence does not say more, by the names that
            `nlcontrol defaults` lists, on top of the scene's.
        objects: all that stands on the caller's own table; null for the simulated one.
    """

    scene: str = Field(default="kitchen", max_length=_LONGEST_PATH, examples=["kitchen"])
    seed: Annotated[int, IsNumber] = Field(default=0, ge=0, lt=2**32, examples=[0])
    defaults: dict[ShortText, Number] = Field(default={}, max_length=100)
    objects: StatedObjects | None = None


class SessionSpec(TableSpec):
    """A session to be opened.

    Attributes:
        approval: `plan`: only plans that were approved are carried out; `none`: sentences are too.
    """

    approval: Literal["plan", "none"] = "none"


def session_spec(
    scene: SessionSpec | str,
    seed: int,
    defaults: Mapping[str, float] | None,
    objects: Iterable[StatedObject] | None,
    approval: Literal["plan", "none"],
) -> SessionSpec:
    """What is asked for of a session; raises `bad_arguments` if it makes no sense."""
    if isinstance(scene, SessionSpec):
        return scene
    try:
        return SessionSpec(
            scene=scene,
            seed=seed,
            defaults=dict(defaults or {}),
            objects=None if objects is None else tuple(objects),
            approval=approval,
        )
    except ValidationError as raised:
        fault = raised.errors(include_url=False)[0]
        place = ".".join(map(str, fault["loc"]))
        raise error(
            "bad_arguments",
            f"`{place}` of a session is {fault['input']!r}: {fault['msg']}",
            suggestions=("docs/sessions.md tells what a session takes",),
        ) from raised


class SessionInfo(Document):
    """A session that is open.

    Attributes:
        session_id: name of the session.
        spec: specification with which it was opened.
        has_robot: plans can be carried out here; not on a table that was stated.
        state: `idle`, `running` (a run is under way or queued) or `lost` (its process has ended).
        run_id: name of the run that is under way or queued.
        expires_in: time until it is closed if nothing is asked of it [s].
    """

    session_id: str
    spec: SessionSpec
    has_robot: bool
    state: Literal["idle", "running", "lost"]
    run_id: str | None = None
    expires_in: float


class SessionList(Document):
    """Sessions.

    Attributes:
        sessions: open sessions.
    """

    sessions: tuple[SessionInfo, ...]


class TableObject(DocumentPart):
    """An object as it is believed to stand, or as it was stated.

    Attributes:
        name: name of the object on this table; text that others wrote.
        model: name of the registry's model that it is taken for.
        x, y: position of B's origin in W [m].
        yaw: heading of B's x axis [rad].
        lies_on: name of the face that is below; `bottom` if it stands as its model does.
        size: size of a box around it as it lies, along its own axes [m].
        fragile: whether hand and other objects keep well away from it.
        fixed: whether a holder keeps it where it stands.
        lid: opening of its lid as seen; null without one.
        mass, mass_sd: present belief, and its standard deviation [kg].
        friction, friction_sd: coefficient at the table, likewise.
    """

    name: str
    model: str
    x: float
    y: float
    yaw: float
    lies_on: str
    size: tuple[float, float, float]
    fragile: bool = False
    fixed: bool = False
    lid: float | None = None
    mass: float
    mass_sd: float
    friction: float
    friction_sd: float


class TableView(Document):
    """The table as it is believed to be.

    Attributes:
        source: `camera` if a robot looked, `stated` if the caller said where everything stands.
        time: time of the robot's clock [s].
        scene: name of the cell.
        objects: objects on the table.
        held: name of the object in the hand; null if it is empty.
        digest: digest of all beliefs; see `nlcontrol.service.offers`.
    """

    source: Source
    time: float
    scene: str
    objects: tuple[TableObject, ...]
    held: str | None
    digest: str


class Drawing(DocumentPart):
    """Places of a plan, or of the reason why there is none, as they are believed.

    Attributes:
        object: name of what is moved, or was to be.
        faces: names of its side faces, as a map takes them; first the one that is pushed, or else
            the one that looks at the robot most.
        lines: what is done, what that does and why it is safe, in words.
        ghosts: objects and the poses in which they should end.
        contacts: first contacts of the fingertips: points and outward normals in B.
        marks: places of a refusal's numbers.
    """

    object: str
    faces: tuple[str, ...] = ()
    lines: tuple[StoryLine, ...] = ()
    ghosts: tuple[Ghost, ...] = ()
    contacts: tuple[ContactMark, ...] = ()
    marks: tuple[Mark, ...] = ()


class Understanding(Document):
    """Frames of a sentence, or why nothing was understood.

    Attributes:
        ok: it was understood.
        text: the sentence as given.
        frames: what is to be done, one after the other.
        paraphrase: the frames in plain words, which are read as the same frames.
        asides: places of words that set nothing.
        left_out: these words.
        error: why it was not understood.
        explanation: which words set which part of a frame; parameters follow with a plan.
    """

    ok: bool
    text: str
    frames: tuple[Frame, ...] = ()
    paraphrase: str | None = None
    asides: Spans = ()
    left_out: tuple[str, ...] = ()
    error: ErrorInfo | None = None
    explanation: tuple[Row, ...] = ()

    def command(self) -> Command:
        """The frames as a command; raises a `ControlError` if it was not understood."""
        if self.error is not None:
            raise ControlError(self.error)
        return Command(
            text=self.text,
            frames=self.frames,
            paraphrase=self.paraphrase or "",
            asides=self.asides,
        )


class Offer(Document):
    """A plan that waits to be approved, or the reason why there is none.

    Attributes:
        plan_id: name with which the plan is executed, once; null if there is nothing to execute.
        expires_in: time for which that is possible [s]; null without a plan id.
        digest: digest of the beliefs at planning.
        result: result of the sentence so far: `planned`, or refused, not understood, answered.
        drawing: drawing of the plan; null if it is about no object on the table.
    """

    plan_id: str | None = None
    expires_in: float | None = None
    digest: str
    result: Result
    drawing: Drawing | None = None

    def __repr__(self) -> str:
        bears = "" if self.plan_id is None else f" as {self.plan_id}"
        return f"<Offer{bears}: {self.result!r}>"

    @property
    def ok(self) -> bool:
        """There is a plan, or an answer."""
        return self.result.ok

    @property
    def status(self) -> ResultStatus:
        """Outcome of planning: `planned`, `answered`, `refused`, `not_understood` and so on."""
        return self.result.status

    @property
    def plan(self) -> Plan | None:
        """The plan of the first step; None if there is none, or if it is reached already."""
        return self.result.plan

    @property
    def error(self) -> ErrorInfo | None:
        """Why there is no plan."""
        return self.result.error


class NumberedEvent(DocumentPart):
    """An event of a run.

    Attributes:
        number: number of the event in its run, from 1.
        event: the event.
    """

    number: int
    event: Event


class RunInfo(Document):
    """A run: something that is carried out.

    Attributes:
        run_id: name of the run.
        session_id: name of its session.
        kind: `execute` (a plan that was approved) or `say` (planned and executed at one go).
        state: `queued`, `running`, `ended` (its `result` says how), `aborted` (its process was
            ended on request), `cut_off` (the service or its process died) or `defect`.
        place: place in the queue, from 1; null if it is not queued.
        text: the sentence.
        plan_id: name of the approved plan; null for `say`.
        scene, seed: scene and seed of the session; null in runs of earlier versions.
        asked_at, begun_at, ended_at: times in seconds since 1970 (UTC).
        events: number of events so far.
        result: result of the sentence, once the run has ended.
        error: why there is no result.
    """

    run_id: str
    session_id: str
    kind: RunKind
    state: RunState
    place: int | None = Field(default=None, ge=1)
    text: str
    plan_id: str | None = None
    scene: str | None = None
    seed: int | None = None
    asked_at: float
    begun_at: float | None = None
    ended_at: float | None = None
    events: int = 0
    result: Result | None = None
    error: ErrorInfo | None = None


class RunPage(Document):
    """Some of the runs, the newest first.

    Attributes:
        runs: runs on this page.
        cursor: cursor of the next page; null on the last one.
    """

    runs: tuple[RunInfo, ...]
    cursor: str | None = None


class Affordances(Document):
    """Outcomes that this robot can bring about with an object; for the others, why not.

    Attributes:
        object: name of the object.
        scene: name of the cell.
        affordances: one for each outcome, direction and face.
    """

    object: str
    scene: str
    affordances: tuple[Affordance, ...]

    @classmethod
    def of(cls, name: str, scene: str, found: Iterable[Affordance]) -> Affordances:
        """The document of what was found out about an object."""
        return cls(object=name, scene=scene, affordances=tuple(found))


class MapContact(DocumentPart):
    """A contact of an outcome map.

    Attributes:
        lateral, height: place on the face [m].
        point: the same point in B [m].
        outcome: `slide`, `topple`, `undecided` or `none`.
        force: force at which the outcome begins [N]; null if never.
        slide, topple: thresholds [N]; null if never.
        probability_slide, probability_topple: probabilities of these outcomes.
    """

    lateral: float
    height: float
    point: tuple[float, float, float]
    outcome: str
    force: float | None
    slide: float | None
    topple: float | None
    probability_slide: float
    probability_topple: float


class FaceMap(Document):
    """Outcomes of pushes all over a face; see `nlcontrol.outcome_maps.outcome_map_table`.

    Attributes:
        object: name of the object.
        face: name of the face, as in the request.
        normal: outward unit normal of the face in B.
        band: forces that lie closer together, as a share, leave the outcome undecided.
        level: probability that an outcome must have, instead of the band; null without.
        friction: coefficient at the table that decided.
        probabilities: which tier they are of, `exact tier` or `closed form`, and whether they are
            interpolated.
        contacts: all over the face.
    """

    object: str
    face: str
    normal: tuple[float, float, float]
    band: float
    level: float | None
    friction: Literal["static", "kinetic"]
    probabilities: str
    contacts: tuple[MapContact, ...]


# Documents for viewers, and for nobody else: shapes of bodies, and their poses over time.
#
# Where the robot is simulated these are the poses that an observer of that world sees; they are
# never told to who plans, perceives or decides.


PoseSource = Literal["observer", "belief"]


class DrawnBody(DocumentPart):
    """A body with its shapes.

    Attributes:
        name: name of the body, as in a `PoseFrame`.
        kind: kind of the body.
        object: name of the object on the table that it is, or whose lid it is; null for others.
        shapes: each with `kind`, `pose` in the body, `colour` (red, green, blue and opacity, 0…1)
            and the measures of its kind [m]; see `sim.views.viewer_recording`.
    """

    name: str
    kind: Literal["world", "robot", "object", "lid"]
    object: str | None
    shapes: tuple[dict[str, Any], ...]


class SceneGeometry(Document):
    """All that a viewer draws of a session.

    Attributes:
        source: source of the shapes: an observer's view, or the believed boxes.
        format: format of the shapes, with its version.
        name: name of the scene.
        floor: height of the ground below the table top [m].
        liquid: colour of liquid.
        bodies: bodies with their shapes.
    """

    source: PoseSource
    format: str
    name: str
    floor: float
    liquid: tuple[float, float, float, float]
    bodies: tuple[DrawnBody, ...]


class PoseFrame(DocumentPart):
    """Places of all bodies at one time.

    Attributes:
        time: time of the robot's clock [s].
        source: source of the poses: an observer of the simulated world, or the beliefs.
        poses: poses by the names of the bodies: quaternion (w, x, y, z) and position in W [m].
    """

    time: float
    source: PoseSource
    poses: dict[str, tuple[float, float, float, float, float, float, float]]


# The host: its health, scenes and objects.


class Health(Document):
    """Numbers of what there is and what waits.

    Attributes:
        version: version of nlcontrol.
        sessions: open sessions.
        planners: processes that plan without a session.
        running: runs that are under way.
        queued: runs in the queue.
    """

    version: str
    sessions: int = Field(ge=0)
    planners: int = Field(ge=0)
    running: int = Field(ge=0)
    queued: int = Field(ge=0)


class SceneSummary(DocumentPart):
    """A scene of the host.

    Attributes:
        name: name of the scene.
        objects: names of its objects.
    """

    name: str
    objects: tuple[str, ...]


class SceneList(Document):
    """Scenes.

    Attributes:
        scenes: scenes that a session may have.
    """

    scenes: tuple[SceneSummary, ...]


class ObjectSummary(DocumentPart):
    """An object model in a few figures.

    Attributes:
        name: name of the model; text that others wrote.
        synonyms: further names.
        kind: kind of shape.
        size: size of a box around it as it stands [m].
        mass, mass_sd: mass and its standard deviation [kg].
        friction, friction_sd: coefficient at the table, and its standard deviation.
    """

    name: str
    synonyms: tuple[str, ...]
    kind: str
    size: tuple[float, float, float]
    mass: float
    mass_sd: float
    friction: float
    friction_sd: float


class ObjectList(Document):
    """Object models of the host.

    Attributes:
        objects: object models in the order of their names.
    """

    objects: tuple[ObjectSummary, ...]


class ObjectDescription(Document):
    """An object model.

    Attributes:
        summary: the model in a few figures.
        model: every figure, as docs/models.md names them.
        geometry: its shapes, for a viewer.
    """

    summary: ObjectSummary
    model: dict[str, Any]
    geometry: SceneGeometry
