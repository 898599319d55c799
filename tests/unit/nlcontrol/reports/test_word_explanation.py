"""No word is unaccounted for, whatever becomes of a sentence."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

import grammar
from nlcontrol.reports.word_explanation import filler, groups, steps, table, word_explanation
from nlcontrol.results.result import Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.plan_explanation import Row

SENTENCES = Path(__file__).parents[3] / "data" / "commands"

WITHOUT_MEANING = (
    "the a an my your our this that that's which there here of by and but then first next finally "
    "after afterwards again now while when if to either i i'd you we me for it its is be could "
    "can will would want like need just go ahead please kindly hey ok okay robot thank thanks "
    "contents pushing should needs mind"
)
"""Articles, joints and politeness."""


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


def _row(result: Result, words: str) -> Row:
    return next(row for row in result.explanation_rows() if row.words == words)


def _values(result: Result) -> dict[str, str]:
    return {row.parameter: row.value for row in result.explanation_rows()}


@pytest.mark.slow
def test_only_words_without_meaning_are_left_over() -> None:
    left = {}
    for path in sorted(SENTENCES.glob("*.yaml")):
        for case in yaml.safe_load(path.read_text(encoding="utf-8")) or ():
            try:
                command = grammar.parse(case["text"])
            except grammar.ParseError:
                continue
            parsed = Result(
                ok=False, status="failed", text=command.text, frames=command.frames,
                scene="", seed=0,
            )  # fmt: skip
            row = word_explanation(parsed)[-1]
            words = set(row.words.split(", ")) if row.part == "filler" else set()
            aside = " ".join(command.text[start:end] for start, end in command.asides)
            words.difference_update(re.findall(r"[\w'’-]+", aside.lower()))
            if words := words.difference(WITHOUT_MEANING.split()):
                left[command.text] = words
    assert not left


def test_fillers_are_listed_once_and_without_punctuation(kitchen: Controller) -> None:
    text = "Please, push the ice tea box away; then push the coffee box away."
    result = Conversation(kitchen).say(text, plan_only=True)
    assert filler(result.explanation_rows()) == "no meaning of their own: please, the, then"
    assert table(result.explanation_rows()).endswith("no meaning of their own: please, the, then")


def test_steps_that_are_not_planned_show_their_frames(kitchen: Controller) -> None:
    result = Conversation(kitchen).say(
        "push the ice tea box away, then topple the cereal box", plan_only=True
    )
    (first, planned), (second, rest) = steps(result.explanation_rows())
    assert (first, second) == ("Step 1", "Step 2, not planned")
    assert {row.frame for row in planned} == {0}
    assert [row.value for row in rest] == ["not planned", "", ""]
    assert [row.words for row in rest] == ["topple", "cereal box", ""]
    assert not any(row.parameter for row in rest)


def test_a_length_in_objects_shows_its_metres(kitchen: Controller) -> None:
    result = Conversation(kitchen).say("push the ice tea box twice its width away", plan_only=True)
    row = next(row for row in result.explanation_rows() if row.parameter == "distance")
    assert (row.words, row.value) == ("twice its width away", "180 mm")  # 2 × 90 mm


def test_a_refused_clause_bears_the_reason_and_its_numbers(kitchen: Controller) -> None:
    result = Conversation(kitchen).say(
        "push the ice tea box at the top without toppling it", plan_only=True
    )
    assert result.status == "refused"
    marked = [row for row in result.explanation_rows() if row.problem]
    assert [(row.words, row.part) for row in marked] == [("at the top", "constraint")]
    assert "153 mm" in marked[0].value
    assert "119 mm" in marked[0].value


@pytest.mark.parametrize(
    ("sentence", "words", "parameter"),
    [
        ("lift the ice tea box", "lift", "cannot be satisfied"),
        ("push the ice tea box away with your left hand", "with your left hand", "not supported"),
        ("push the violin away", "violin", "cannot be satisfied"),
        ("push the ice tea box 10 cm towards it", "it", "cannot be satisfied"),
    ],
)  # fmt: skip
def test_what_stops_a_sentence_is_marked(
    kitchen: Controller, sentence: str, words: str, parameter: str
) -> None:
    result = Conversation(kitchen).say(sentence, plan_only=True)
    (marked,) = [row for row in result.explanation_rows() if row.problem]
    assert words in marked.words
    assert marked.parameter == parameter
    assert result.error is not None
    assert marked.value == result.error.message


def test_a_question_of_force(kitchen: Controller) -> None:
    result = Conversation(kitchen).say(
        "how hard do I have to push the ice tea box to make it slide?"
    )
    values = _values(result)
    assert values["force"] == "3.7 N ± 0.7 N"  # μ m g
    assert (values["face"], values["direction"]) == ("the front face", "away")
    assert values["mass"].startswith("0.995")
    assert _row(result, "how hard do I have to push … to make it slide").part == "question"


def test_a_question_that_says_where_and_how_hard(kitchen: Controller) -> None:
    result = Conversation(kitchen).say(
        "what happens if you push the ice tea box at the top with 4 N?"
    )
    assert _row(result, "at the top").value == "192 mm"  # the middle of the upper third
    assert _row(result, "with 4 N").value == "4.0 N"
    assert _values(result)["answer"] == "it topples first"


@pytest.mark.parametrize(
    ("question", "parameter", "value"),
    [
        ("can you push the ice tea box away?", "answer", "yes"),
        ("can you push the ice tea box at the top without toppling it?", "because", "153 mm"),
        ("where can I push the ice tea box without toppling it?", "places", "5 mm to 85 mm"),
        ("how heavy is the soup can?", "mass", "0.349 kg ± 0.018 kg"),
        ("where is the ice tea box?", "x", " mm ± "),
        ("what happens if you push the ice tea box with 1 N?", "answer", "it stays where it is"),
    ],
)
def test_the_number_that_answers(
    kitchen: Controller, question: str, parameter: str, value: str
) -> None:
    assert value in _values(Conversation(kitchen).say(question))[parameter]


def test_an_unanswered_question(kitchen: Controller) -> None:
    rows = Conversation(kitchen).say("why?").explanation_rows()
    assert [row.value for row in rows] == ["not answered", "nothing was said or done yet"]


def test_a_why_is_answered_in_words(kitchen: Controller) -> None:
    talk = Conversation(kitchen)
    talk.say("push the ice tea box at the top without toppling it", plan_only=True)
    assert "153 mm" in _values(talk.say("why?"))["answer"]


def test_what_was_said_before_has_no_words_here(kitchen: Controller) -> None:
    talk = Conversation(kitchen)
    talk.say("push the ice tea box 5 cm away", plan_only=True)
    result = talk.say("again", plan_only=True)
    assert result.status == "planned"
    first, *others = groups(result.explanation_rows())
    assert first.words == "again"
    assert not any(group.words for group in others)


def test_a_result_read_from_json_keeps_its_explanation(kitchen: Controller) -> None:
    result = Conversation(kitchen).say("push the ice tea box away", plan_only=True)
    explained = result.model_copy(update={"explanation": result.explanation_rows()})
    again = Result.model_validate_json(explained.to_json())
    assert again.explanation_rows() == result.explanation_rows()
    bare = Result.model_validate_json(result.to_json())
    assert not re.search("not planned", table(bare.explanation_rows()))


def test_nothing_understood_is_nothing_explained(kitchen: Controller) -> None:
    assert Conversation(kitchen).say("boil two eggs").explanation_rows() == ()
