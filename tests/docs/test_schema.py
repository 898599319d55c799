"""The JSON contract: names that other programs read."""

from __future__ import annotations

import json
import re
from typing import Any, get_args

from grammar.frames import command as g
from nlcontrol.json_document import SCHEMA_VERSION
from nlcontrol.json_schema import schema
from planner.types.defaults import settings


def _definition(name: str) -> dict[str, Any]:
    definitions: Any = schema()["$defs"]
    found: dict[str, Any] = definitions[name]
    return found


def test_the_answers_of_the_commands() -> None:
    assert list(_definition("Command")["properties"]) == [
        "schema_version", "ok", "text", "frames", "paraphrase", "asides"
    ]  # fmt: skip
    assert {
        "ok",
        "status",
        "text",
        "frames",
        "paraphrase",
        "plan",
        "checks",
        "seed",
        "answer",
        "error",
    } <= set(_definition("Result")["properties"])
    assert set(_definition("Result")["properties"]["status"]["enum"]) >= {
        "done", "answered", "failed", "refused", "not_understood", "unsupported",
    }  # fmt: skip
    assert {"clause", "spans", "expected", "measured", "tolerance", "ok"} <= set(
        _definition("Check")["properties"]
    )
    assert {
        "query", "text", "lines", "objects", "numbers", "probability", "yes", "reason",
        "suggestions", "push", "chart",
    } == set(_definition("Answer")["properties"])  # fmt: skip
    assert {"words", "field", "parameter", "value", "spans"} <= set(
        _definition("Row")["properties"]
    )
    query, null = _definition("Answer")["properties"]["query"]["anyOf"]
    assert (set(query["enum"]), null) == (set(get_args(g.Query)), {"type": "null"})
    assert set(_definition("Chart")["properties"]) == {"object", "face"}
    assert {"outcome", "onset", "slide_sd", "probability", "residual", "friction"} <= set(
        _definition("PushPrediction")["properties"]
    )
    assert {"code", "message", "span", "suggestions"} <= set(_definition("ErrorInfo")["properties"])


def test_what_is_found_by_touching() -> None:
    assert {"ok", "object", "parameters", "unidentified", "saved"} <= set(
        _definition("FitReport")["properties"]
    )
    assert list(_definition("ExplorationReport")["properties"]) == [
        "schema_version", "ok", "object", "scene", "seed", "touches", "repeated", "parameters",
        "correlations", "friction_spread", "rms", "support", "given_up", "dropped", "notes",
        "truth", "saved",
        "instead_of", "files", "error",
    ]  # fmt: skip
    assert list(_definition("TouchMade")["properties"]) == [
        "experiment", "outcome", "as_meant", "force"
    ]  # fmt: skip
    assert list(_definition("Statistics")["properties"]) == [
        "mean", "sd", "percent", "least", "most", "n"
    ]  # fmt: skip
    assert {"value", "sd", "percent", "low", "high", "believed", "believed_sd"} == set(
        _definition("FittedParameter")["properties"]
    )


def test_what_a_push_teaches() -> None:
    assert list(_definition("Lesson")["properties"]) == [
        "object", "moved", "force", "surprise", "contradicts", "why", "changes"
    ]  # fmt: skip
    assert _definition("Lesson")["properties"]["moved"]["enum"] == [
        "slide", "topple", "slip", "lift", "none"
    ]  # fmt: skip
    assert list(_definition("Change")["properties"]) == [
        "parameter", "before", "before_sd", "after", "after_sd"
    ]  # fmt: skip
    assert _definition("Step")["properties"]["lessons"]["items"] == {"$ref": "#/$defs/Lesson"}


def test_every_answer_is_one_of_them() -> None:
    answers: Any = schema()["anyOf"]
    assert {answer["$ref"] for answer in answers} == {
        f"#/$defs/{name}"
        for name in (
            "Result", "Command", "PushPrediction", "DragPrediction", "FitReport",
            "ExplorationReport", "RowResult", "BatchSummary", "Failure",
        )
    }  # fmt: skip


def test_the_names_of_the_frames() -> None:
    frame = _definition("Frame")["properties"]
    assert {"action", "query", "dialogue", "object", "goal", "constraints"} <= set(frame)
    goals = set(frame["goal"]["discriminator"]["mapping"])
    assert goals == {
        "displace", "place", "rotate", "tilt", "topple", "upright", "lift", "set_down", "open",
        "close", "pour", "hand_over", "parameters", "none",
    }  # fmt: skip
    constraints = set(frame["constraints"]["items"]["discriminator"]["mapping"])
    assert constraints == {
        "no_topple", "no_tilt", "no_turn", "no_slide", "no_lift", "no_spill", "no_touch",
        "max_tilt", "max_turn", "max_force", "min_force", "force", "max_speed", "min_speed",
        "speed", "max_duration", "duration", "max_distance",
        "gentle", "hard", "slow", "fast", "contact", "effector", "until",
    }  # fmt: skip
    assert set(get_args(g.Action)) == {
        "push", "pull", "move", "slide", "turn", "tilt", "topple", "lift", "place", "open",
        "close", "pour", "explore", "hand_over",
    }  # fmt: skip


def test_every_field_of_a_frame_is_described() -> None:
    definitions: Any = schema()["$defs"]
    named, found = ["Command"], set()
    while named:
        name = named.pop()
        found.add(name)
        for field in definitions[name]["properties"].values():
            assert field["description"], name
        inner = re.findall(r'"#/\$defs/(\w+)"', json.dumps(definitions[name]))
        named += [other for other in inner if other not in found]
    assert {"Frame", "ObjectRef", "Pour", "ContactHeight", "RelativeLength", "Until"} <= found
    said = definitions["Displace"]["properties"]["heading"]["description"]
    assert "counter-clockwise from +x of W [rad]" in said
    assert "Attributes" not in definitions["Displace"]["description"]


def test_what_can_be_set() -> None:
    properties = _definition("Defaults")["properties"]
    assert set(properties) == {setting.name for setting in settings()}
    assert properties["turn_deg"] == {
        "type": "number", "exclusiveMinimum": 0, "maximum": 360.0, "default": 90.0,
        "description": "angle of a turn, if none is said",
    }  # fmt: skip
    assert properties["place_gap_m"]["minimum"] == 0


def test_it_is_one_json_document_without_the_trace() -> None:
    document = json.loads(json.dumps(schema()))
    assert document["$schema"].startswith("https://json-schema.org/")
    assert "trace" not in document["$defs"]["Result"]["properties"]


def test_every_answer_bears_a_version() -> None:
    for answer in schema()["anyOf"]:
        found = _definition(answer["$ref"].rpartition("/")[2])
        assert list(found["properties"])[:2] == ["schema_version", "ok"]
        assert {"schema_version", "ok"} <= set(found["required"])
        assert re.fullmatch(found["properties"]["schema_version"]["pattern"], SCHEMA_VERSION)


def test_a_plan_is_a_list_of_actions() -> None:
    assert list(_definition("Plan")["properties"]) == [
        "status", "object", "task", "actions", "committed", "limits", "speed", "aim",
        "probability", "defaults", "considered", "satisfying", "notes",
    ]  # fmt: skip
    actions = _definition("Plan")["properties"]["actions"]["items"]["discriminator"]["mapping"]
    assert set(actions) == {
        "push", "grasp", "lift_up", "carry", "turn_over", "pour_out", "set_down", "set_on",
        "flip_over", "turn_cap", "put_on",
    }  # fmt: skip
    assert set(_definition("Plan")["properties"]["task"]["enum"]) == {
        "push", "topple", "tilt", "lift", "place", "stand", "pour", "open", "close",
    }  # fmt: skip
