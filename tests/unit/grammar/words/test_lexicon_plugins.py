"""Words that other packages bring: what an entry point may name, and what is refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib.metadata import EntryPoint
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from grammar import ParseError, parse
from grammar.parser import Parser, default_parser, parser_for
from grammar.words import lexicon_plugins as plugins
from grammar.words.lexicon import default_lexicon
from objectmodels.files.yaml_documents import LIMITS

SCOOT = """
WORDS = {"verbs": [{"says": ["shimmy"], "action": "slide", "goal": "displace"}]}
"""
PORT = """
WORDS = {"terminals": {"DIRECTION": {"left": ["to port"]}}}
"""

Install = Callable[..., None]
_numbers = count()


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Makes modules the installed plug-ins: their sources by the name of the entry point."""
    monkeypatch.syspath_prepend(tmp_path)

    def installed(**sources: str) -> None:
        points = []
        for name, source in sources.items():
            module = f"words_of_{name}_{next(_numbers)}"  # another one for each test
            (tmp_path / f"{module}.py").write_text(source, encoding="utf-8")
            points.append(EntryPoint(name, f"{module}:WORDS", plugins.GROUP))
        monkeypatch.setattr(plugins, "entry_points", lambda group: points)
        _forget()

    yield installed
    monkeypatch.undo()
    _forget()


def _forget() -> None:
    plugins.installed_lexicon.cache_clear()
    default_parser.cache_clear()


def action(text: str) -> str | None:
    (frame,) = parse(text).frames
    return frame.action


def test_without_plug_ins_the_language_is_its_own(install: Install) -> None:
    install()
    assert plugins.installed_lexicon() == (default_lexicon(), ())


def test_mapping(install: Install) -> None:
    install(
        workshop="""
WORDS = {
    "verbs": [{"says": ["shimmy"], "action": "slide", "goal": "displace"}],
    "terminals": {"DIRECTION": {"left": ["to port"]}},
    "adjectives": {"grey": ["silver"]},
    "names": ["hard drive"],
}
"""
    )
    (frame,) = parse("shimmy the silver hard drive to port").frames
    assert frame.object is not None
    assert (frame.action, frame.goal.model_dump()["direction"]) == ("slide", "left")
    assert (frame.object.text, frame.object.qualities) == ("silver hard drive", ("grey",))
    assert plugins.installed_lexicon()[1] == ()


def test_path_of_a_file(install: Install, tmp_path: Path) -> None:
    file = tmp_path / "words.yaml"
    file.write_text('verbs: [{says: ["shimmy"], action: "slide", goal: "displace"}]\n')
    install(text=f"WORDS = {str(file)!r}")
    assert action("shimmy the box away") == "slide"
    install(path=f"import pathlib\nWORDS = pathlib.Path({str(file)!r})")
    assert action("shimmy the box away") == "slide"


def test_function(install: Install) -> None:
    install(called=f"{SCOOT}\n_words = WORDS\ndef WORDS():\n    return _words\n")
    assert action("shimmy the box away") == "slide"


def test_words_of_several_plug_ins_come_together(install: Install) -> None:
    install(first=SCOOT, second=PORT)
    (frame,) = parse("shimmy the box to port").frames
    assert (frame.action, frame.goal.model_dump()["direction"]) == ("slide", "left")


@pytest.mark.parametrize(
    ("source", "why"),
    [
        ("raise OSError('no such device')", "OSError: no such device"),
        ("NOTHING = 1", "AttributeError"),
        ("WORDS = {'verbs': [], 'nouns': [], 'colours': {}}", "words have no colours, nouns"),
        ("WORDS = 3", "TypeError: expected a mapping, a path or a function, found int"),
        ("WORDS = 'no/such/file.yaml'", "no/such/file.yaml is no regular file"),
        ("WORDS = '/dev/zero'", "/dev/zero is no regular file"),
        ("def WORDS():\n    raise KeyError('later')", "KeyError: 'later'"),
        (
            "WORDS = {'verbs': [{'says': ['push'], 'action': 'pull', 'goal': 'displace'}]}",
            "VERB: 'push' means both",
        ),
        (
            "WORDS = {'terminals': {'DIRECTION': {'away': ['to the left']}}}",
            "DIRECTION: 'to the left' means both left and away",
        ),
        ("WORDS = {'terminals': {'COLOUR': {'red': ['red']}}}", "no terminal is called COLOUR"),
        ("WORDS = {'adjectives': {'shiny': ['shiny']}}", "not told apart by shiny"),
        ("WORDS = {'verbs': [{'action': 'slide', 'goal': 'displace'}]}", "KeyError: 'says'"),
    ],
)
def test_a_bad_plug_in_is_reported_and_the_others_are_kept(
    install: Install, source: str, why: str
) -> None:
    install(bad=source, good=SCOOT)
    _, (problem,) = plugins.installed_lexicon()
    assert problem.startswith("plug-in 'bad' of words_of_bad")
    assert why in problem
    assert action("shimmy the box away") == "slide"
    assert action("push the box to the left") == "push"


def test_nothing_of_a_bad_plug_in_is_taken(install: Install) -> None:
    install(
        half="""
WORDS = {
    "verbs": [{"says": ["shimmy"], "action": "slide", "goal": "displace"}],
    "terminals": {"DIRECTION": {"away": ["to the left"]}},
}
"""
    )
    assert plugins.installed_lexicon()[0] == default_lexicon()
    with pytest.raises(ParseError) as caught:
        parse("shimmy the box away")
    assert caught.value.code == "unknown_verb"


# --- names -----------------------------------------------------------------------------------

NAMES = ("hard drive", "ice tea box", "can opener")


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("push the hard drive gently away", "hard drive"),
        ("push the ice tea box gently away", "ice tea box"),
        ("push the can opener gently away", "can opener"),
        ("push the big hard drive gently away", "big hard drive"),
        ("push hard drive gently away", "hard drive"),
    ],
)
def test_names_of_objects_are_read_whole(text: str, name: str) -> None:
    (frame,) = parser_for(NAMES).parse(text).frames
    assert frame.object is not None
    assert frame.object.text == name
    assert [clause.kind for clause in frame.constraints] == ["gentle"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("push block 5 away", "push the block 5 away"),
        ("push block 5 until it touches block 2", "push the block 5 until it touches the block 2"),
        ("push the block 5 5 cm away", "push the block 5 away by 5 cm"),
        ("push the block 5 cm away", "push the block away by 5 cm"),
        ("put block 5 in the mug", "put the block 5 in the mug"),
        ("push all but block 5 away", "push all except for the block 5 away"),
    ],
)
def test_names_that_end_in_a_number_are_no_lengths(text: str, said: str) -> None:
    assert parser_for(["block 5", "block 2", "mug"]).parse(text).paraphrase == said


def test_names_that_are_read_anyway_take_the_words_that_there_are() -> None:
    assert parser_for(["ice tea box", "mug"]).lexicon is default_parser().lexicon


@pytest.mark.parametrize(
    "words",
    [
        {"verbs": [{"says": ["fling"], "action": "throw", "goal": "displace"}]},
        {"verbs": [{"says": ["fling"], "action": "push", "goal": "far"}]},
        {"verbs": [{"says": "fling", "action": "push", "goal": "displace"}]},
        {"verbs": [{"says": ["fling across"], "action": "push", "goal": "displace"}]},
        {"verbs": [{"says": ["Fling"], "action": "push", "goal": "displace"}]},
        {"terminals": {"DIRECTION": {"north": ["northwards"]}}},
        {"terminals": {"DIRECTION": {"away": ["To The North"]}}},
        {"terminals": {"LENGTH_UNIT": {"long": ["furlong"]}}},
    ],
)
def test_words_that_could_mean_nothing_are_refused(words: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"[Ff]ling|northwards|To The North|furlong"):
        default_lexicon().with_words(**words)


def test_unit_of_a_plug_in() -> None:
    lexicon = default_lexicon().with_words(terminals={"LENGTH_UNIT": {"0.1016": ["hands"]}})
    (frame,) = Parser(lexicon).parse("push the box away two hands").frames
    assert frame.goal.model_dump()["distance"] == pytest.approx(2 * 0.1016)  # rounding alone


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"verbs: []\n" + b"#" * plugins.MOST_BYTES, "holds more than 1000000 bytes"),
        (b"a: &a [x, x]\nb: &b [*a, *a]\nverbs: [*b, *b]\n", "has aliases"),
        (b"\xff\xfe\x00", "UnicodeDecodeError"),
        (b"[" * 1_500 + b"]" * 1_500, "RecursionError"),
        (b"verbs: !!python/name:os.system", "ConstructorError"),
    ],
)
def test_a_file_of_words_is_read_within_limits(
    install: Install, tmp_path: Path, content: bytes, why: str
) -> None:
    (tmp_path / "words.yaml").write_bytes(content)
    install(bad=f"WORDS = {str(tmp_path / 'words.yaml')!r}", good=SCOOT)
    _, (problem,) = plugins.installed_lexicon()
    assert why in problem
    assert action("shimmy the box away") == "slide"


def test_the_limit_is_that_of_the_table() -> None:
    assert LIMITS["lexicon_file"].most == plugins.MOST_BYTES


@pytest.mark.parametrize("name", ["push", "it", "and", "toppling it", "Away"])
def test_words_of_the_language_are_no_names(install: Install, name: str) -> None:
    install(odd=f"WORDS = {{'names': [{name!r}]}}")
    lexicon, problems = plugins.installed_lexicon()
    assert lexicon == default_lexicon()
    assert len(problems) == 1
    assert name in problems[0]


def test_words_that_end_the_program_are_skipped(install: Install) -> None:
    install(odd="raise SystemExit(3)", scoots=SCOOT)
    _, problems = plugins.installed_lexicon()
    assert len(problems) == 1
    assert action("shimmy the mug away") == "slide"
