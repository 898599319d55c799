"""The guide to the language and its reference: their sentences mean what they say, their runs print
what they show.

In its tables a sentence stands between “ and ”; commas join sentences that mean the same, and
semicolons separate those that do not.
"""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import textwrap
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from grammar import ParseError, parse
from grammar.parser import default_parser
from grammar.words.lexicon_plugins import installed_lexicon
from nlcontrol.cli import run
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.types.defaults import DEFAULTS
from tests.docs.guide_blocks import code_blocks, only_block

DOCS = Path(__file__).parents[2] / "docs"
GUIDE = (DOCS / "language.md").read_text(encoding="utf-8")
REFERENCE = (DOCS / "language_reference.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", REFERENCE, re.MULTILINE | re.DOTALL))
INTRODUCTION = REFERENCE.partition("\n## ")[0]
REFUSALS = "What is not understood"
PROMPT = re.compile(r"^(?:\$ nlcontrol|nlcontrol>) (.*)\n", re.MULTILINE)


def rows(text: str) -> list[tuple[str, str]]:
    """First and second cell of the rows of all tables that hold sentences."""
    found = re.findall(r"^\| (.*?) ?\| (.*) \|$", text, re.MULTILINE)
    return [(first, second) for first, second in found if "“" in second]


def sentences(cell: str) -> list[str]:
    return re.findall(r"“([^”]*)”", cell)


def codes(cell: str) -> set[str]:
    return set(re.findall(r"`([^`]*)`", cell))


def bare(value: Any) -> Any:
    """JSON without the places of the words."""
    if isinstance(value, dict):
        return {key: bare(part) for key, part in value.items() if key != "spans"}
    return [bare(part) for part in value] if isinstance(value, list) else value


def meaning(sentence: str) -> Any:
    return bare(parse(sentence).model_dump(mode="json")["frames"])


UNDERSTOOD = [
    row
    for name, text in {"": INTRODUCTION, **SECTIONS, "guide": GUIDE}.items()
    if name != REFUSALS
    for row in rows(text)
]
PROSE = re.sub(r"^(?:```.*?^```|\|[^\n]*)$", "", GUIDE, flags=re.MULTILINE | re.DOTALL)  # fmt: skip
REFUSED = rows(SECTIONS[REFUSALS])
NOT_DONE = rows(SECTIONS["What this robot does"])


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


@pytest.mark.parametrize("cell", [second for _, second in UNDERSTOOD])
def test_sentences_of_a_row_are_understood_and_mean_the_same(cell: str) -> None:
    for group in cell.split(";"):
        meanings = {text: meaning(text) for text in sentences(group)}
        for text, found in meanings.items():
            assert found == next(iter(meanings.values())), text


def test_sentences_of_the_walk_are_understood() -> None:
    said = [" ".join(text.split()) for text in sentences(PROSE)]
    assert len(said) > 8
    assert all(parse(text).frames for text in said)


def test_the_cheat_sheet_fits_on_a_page() -> None:
    sheet = GUIDE.partition("\n## Cheat sheet\n")[2]
    assert len(rows(sheet)) > 20
    lines = (textwrap.wrap(line, 110) or [""] for line in sheet.splitlines())
    assert sum(map(len, lines)) <= 60  # of A4 at 9 points


def test_verbs_give_the_action_of_their_row() -> None:
    found = {
        first: {frame.action for text in sentences(cell) for frame in parse(text).frames}
        for first, cell in rows(SECTIONS["Verbs"])
    }
    assert len(found) > 10
    assert found == {first: codes(first) for first in found}


def test_tables_are_found() -> None:
    assert sum(len(sentences(cell)) for _, cell in UNDERSTOOD) > 150


@pytest.mark.parametrize(("named", "cell"), REFUSED)
def test_refusals_have_the_codes_of_their_row(kitchen: Controller, named: str, cell: str) -> None:
    told = [Conversation(kitchen).say(text, plan_only=True) for text in sentences(cell)]
    assert {result.error.code for result in told if result.error} == codes(named)
    assert all(result.exit_status == 3 for result in told)


@pytest.mark.parametrize(("capability", "cell"), NOT_DONE)
def test_what_has_no_controller_is_named(kitchen: Controller, capability: str, cell: str) -> None:
    for text in sentences(cell):
        result = Conversation(kitchen).say(text, plan_only=True)
        assert result.status == "unsupported"
        assert result.error is not None
        assert {result.error.capability} == codes(capability)


def test_too_long() -> None:
    assert parse("push the mug away".ljust(500)).frames
    with pytest.raises(ParseError) as caught:
        parse("push the mug away".ljust(501))
    assert caught.value.code == "too_long"


# --- runs ------------------------------------------------------------------------------------


def told(block: str) -> list[tuple[str, str]]:
    """Each input of a block, and what is shown of the answer, in one line."""
    _, *parts = PROMPT.split(block)
    return [(said, _flat(shown)) for said, shown in zip(parts[::2], parts[1::2], strict=True)]


def _flat(text: str) -> str:
    return " ".join(text.split())


RUNS = [
    each
    for block in code_blocks(GUIDE, "console")
    if "$ nlcontrol shell" not in block
    for each in told(block)
]
(CONVERSATION,) = (
    told(block)[1:] for block in code_blocks(GUIDE, "console") if "$ nlcontrol shell" in block
)


@pytest.mark.parametrize(
    ("command", "shown"),
    [
        pytest.param(command, shown, marks=pytest.mark.slow if "what can you" in command else ())
        for command, shown in RUNS
    ],
    ids=[command for command, _ in RUNS],
)
def test_the_guide_shows_what_is_printed(
    capsys: pytest.CaptureFixture[str], command: str, shown: str
) -> None:
    run(shlex.split(command))
    printed = capsys.readouterr()
    assert shown
    assert shown in _flat(printed.out + printed.err)


@pytest.mark.slow
def test_the_conversation_goes_as_it_is_shown() -> None:
    conversation = Conversation(Controller("kitchen"))
    for said, shown in CONVERSATION:
        assert _without_figures(shown) in _without_figures(conversation.say(said).report())


def _without_figures(text: str) -> str:
    """What a simulation measures differs by a millimetre from one machine to another."""
    return re.sub(r"\d+", "#", _flat(text))


# --- for those who extend it -----------------------------------------------------------------


def test_the_python_of_the_guide() -> None:
    code = only_block(REFERENCE, "python")
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, "language_reference.md", "exec"), {})
    comment = code.rstrip().rpartition("# ")[2]
    assert out.getvalue().strip() == comment


def test_the_example_of_a_sentence_file_holds() -> None:
    ((case,),) = (yaml.safe_load(block) for block in code_blocks(REFERENCE, "yaml"))
    (frame,) = parse(case["text"]).frames
    found, meant = frame.model_dump(mode="json"), case["frame"]
    assert (found["action"], found["object"]["text"]) == (meant["action"], meant["object"])
    assert meant["goal"].items() <= found["goal"].items()


@pytest.fixture
def workshop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The package of the guide, as it stands in a folder of installed packages."""
    code, project = (only_block(REFERENCE, each) for each in ("python words", "toml"))
    (tmp_path / "workshop.py").write_text(code, encoding="utf-8")
    info = tmp_path / "nlcontrol_workshop-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Name: nlcontrol-workshop\nVersion: 1.0\n")
    ((group, points),) = tomllib.loads(project)["project"]["entry-points"].items()
    lines = [f"[{group}]", *(f"{name} = {value}" for name, value in points.items())]
    (info / "entry_points.txt").write_text("\n".join(lines))
    monkeypatch.syspath_prepend(tmp_path)
    _forget()
    yield
    _forget()


def _forget() -> None:
    installed_lexicon.cache_clear()
    default_parser.cache_clear()


@pytest.mark.usefixtures("workshop")
def test_the_plug_in_of_the_guide() -> None:
    _, problems = installed_lexicon()
    assert not problems
    (text,) = re.findall(r"^Now “([^”]*)”", REFERENCE, re.MULTILINE)
    (frame,) = parse(text).frames
    assert frame.object is not None
    assert frame.action == "slide"
    assert (frame.object.text, frame.object.qualities) == ("silver hard drive", ("grey",))
    assert frame.goal.model_dump()["direction"] == "left"
    assert [clause.kind for clause in frame.constraints] == ["gentle"]


def test_without_the_plug_in_its_words_are_unknown() -> None:
    with pytest.raises(ParseError) as caught:
        parse("shimmy the mug to port")
    assert caught.value.code == "unknown_verb"


def test_the_guide_says_how_far_almost_is() -> None:
    assert f"by {DEFAULTS.tilt_lot:.0%}".replace("%", " %") in REFERENCE
