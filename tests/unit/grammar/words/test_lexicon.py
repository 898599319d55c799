"""The lexicon: templates, words that can be found, and words of a plug-in."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Hashable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, get_args

import pytest
import yaml

from grammar import ParseError, parse
from grammar.frames.command import Action, Goal, Quality
from grammar.parser import Parser
from grammar.phrases.lalr_parser import RULES, LalrParser, parse_table
from grammar.words import lexicon as module
from grammar.words.lexicon import (
    NAME_TERMINALS,
    STORED,
    WORDS,
    default_lexicon,
    words_data,
)
from grammar.words.normalisation import normalise
from grammar.words.phrase_lexer import PhraseLexer, Token
from grammar.words.phrase_templates import expand_template
from tests.patience import PATIENCE

LEXICON = default_lexicon()
LEXER = PhraseLexer(LEXICON)
TERMINALS = (*NAME_TERMINALS, *LEXICON.terminals)

# What the lexer looks for behind a phrase before it takes it; "box" stands for any name.
FOLLOWERS = {
    **dict.fromkeys(("BY", "BOUND", "RANGE", "FROM"), "10"),
    "AND_WITH": "the box",
    "BE": "pushed",
    "CUPS": "tea",
    "EXCHANGED_WITH": "the box",
    "FILLER": "push",
    "IS_AT": "10",
    "NEEDS": "pushing",
    "NOT": "topple",
    "OF": "the box",
    "OR": "topple",
    "PORTION": "the",
    "RELATION": "the",
    "RIGHTS": "the box",
    "SAME": "the box",
    "SOME_OF": "tea",
    "WHICH": "box is the tallest",
    "WHICH_IS": "heavier",
    "TO_BE": "pushed",
    "TO_DO": "topple",
    "TO_LEVEL": "80 percent",
    "WHY_DID": "push",
}

# The verb behind which it looks for them.
VERBS = {
    "CUPS": "pour", "EXCHANGED_WITH": "swap", "FILLED": "fill", "FILLED_WITH": "fill",
    "ON_TABLE": "put", "PORTION": "pour", "SOME_OF": "pour", "STROKE": "give",
}  # fmt: skip
LAST = {"OR": "AVOID", "PART_OF": "VOLUME_UNIT", "PARTICLE": "VERB", "SOME_OF": "VERB"}


@pytest.mark.parametrize(
    ("template", "phrases"),
    [
        ("push", ["push"]),
        ("(a|b) c", ["a c", "b c"]),
        ("a [b]", ["a", "a b"]),
        ("to (the|your) left [side]", [
            "to the left", "to the left side", "to your left", "to your left side",
        ]),
        ("a[b [c|d]] e", ["a e", "ab e", "ab c e", "ab d e"]),
        ("away [from (me|you)]", ["away", "away from me", "away from you"]),
    ],
)  # fmt: skip
def test_templates_expand(template: str, phrases: list[str]) -> None:
    assert expand_template(template) == phrases


def every_phrase() -> list[str]:
    return sorted({phrase for name in TERMINALS for phrase in LEXICON.phrases_of(name)})


# --- the phrases ------------------------------------------------------------------------------


def test_phrases_are_in_plain_form() -> None:
    for phrase in every_phrase():
        assert phrase == " ".join(phrase.split()).casefold()
        # "table's edge", "cm/s", "80 %", and the full stop before "then".
        assert not set(phrase) - set("abcdefghijklmnopqrstuvwxyz ,°%'/.;!?")


@pytest.mark.parametrize("name", TERMINALS)
def test_phrases_stay_what_they_are_in_a_sentence(name: str) -> None:
    # Contractions and hyphens of the lexicon itself would never be met in a plain sentence.
    for phrase in LEXICON.phrases_of(name):
        if phrase.strip(" .,;!?"):
            assert normalise(f"box {phrase} box", LEXICON.contractions).text == f"box {phrase} box"


def lexed(name: str, phrase: str) -> Token:
    """The first token, where nothing but one terminal is acceptable."""
    verb = f"{VERBS.get(name, '')} ".lstrip()
    text = f"{verb}{phrase} {FOLLOWERS.get(name, '')}".rstrip()
    known = SimpleNamespace(last=LAST.get(name, ""), determined="", words=0, adjectival=False)
    kind, end = LEXER._next_token(text, len(verb), name.__eq__, known)  # type: ignore[arg-type]
    return Token(kind, text[len(verb) : end], len(verb), end)


@pytest.mark.parametrize("name", TERMINALS)
def test_every_phrase_is_found_whole(name: str) -> None:
    for phrase in LEXICON.phrases_of(name):
        token = lexed(name, phrase)
        assert (token.type, str(token)) == (name, phrase)


def test_longest_phrase_that_can_stand_there_is_taken() -> None:
    lalr = LalrParser(parse_table(), LEXER)
    tokens = lalr.parse("push the left box away from me with at most 5 n").leaves()
    assert [(token.type, str(token)) for token in tokens] == [
        ("VERB", "push"), ("THE", "the"), ("WORD", "left"), ("WORD", "box"),
        ("DIRECTION", "away from me"), ("WITH", "with"), ("BOUND", "at most"),
        ("NUMBER", "5"), ("FORCE_UNIT", "n"),
    ]  # fmt: skip


def test_rules_and_lexicon_have_the_same_terminals() -> None:
    used = set(
        re.findall(r"\b[A-Z][A-Z_]*\b", re.sub(r"//.*", "", RULES.read_text(encoding="utf-8")))
    )
    assert used == {*TERMINALS, "WORD", "KNOWN", "QUOTED", "NUMBER", "NUMBER_WORD"}


def test_labels_name_terminals() -> None:
    assert LEXICON.labels.keys() <= {"WORD", "NUMBER", *TERMINALS}


def test_lexicon_survives_yaml_s_own_words() -> None:
    # YAML 1.1 would read an unquoted "no" or "on" as a truth value.
    assert "NO" in LEXICON.terminals
    assert LEXICON.value_of("RELATION", "on") == "on"
    assert "on" in LEXICON.later_words
    assert all(isinstance(phrase, str) for phrase in every_phrase())


# --- verbs ------------------------------------------------------------------------------------


def test_verbs_give_actions_and_goals_of_the_contract() -> None:
    goals = {m.model_fields["kind"].default for m in get_args(get_args(Goal)[0])}
    for verb in LEXICON.verbs.values():
        assert verb.action in get_args(Action)
        # A touch alone has no goal; it gets one from what the sentence says. Filling is pouring;
        # what is removed is taken from somewhere, or a lid. Others are goals of several frames, or
        # get the one that the sentence leaves open.
        several = {"swap", "line_up", "clear", "straighten"}
        assert verb.goal in goals - {"none"} | {"contact", "fill", "remove"} | several


def test_no_words_are_both_read_and_put_off() -> None:
    verbs = LEXICON.verb_words["VERB"].keys()
    assert not verbs & LEXICON.later_verbs.keys()
    assert not verbs & LEXICON.later_words
    assert not verbs & LEXICON.vague.keys()


def test_vague_words_name_what_is_read() -> None:
    for instead in LEXICON.vague.values():
        for phrase in instead:
            frame = parse(f"push it {phrase}").frames[0]
            goal = frame.goal.model_dump()
            assert frame.constraints or {"direction", "reference", "distance", "amount"} & {
                k for k, v in goal.items() if v
            }


FORMS = {
    "push": ("pushed", "pushing"), "shove": ("shoved", "shoving"), "nudge": ("nudged", "nudging"),
    "sweep": ("swept", "sweeping"), "deliver": ("delivered", "delivering"),
    "separate": ("separated", "separating"), "carry": ("carried", "carrying"),
    "cart": ("carted", "carting"), "ferry": ("ferried", "ferrying"),
    "press": ("pressed", "pressing"), "poke": ("poked", "poking"), "prod": ("prodded", "prodding"),
    "tap": ("tapped", "tapping"), "pull": ("pulled", "pulling"), "drag": ("dragged", "dragging"),
    "draw": ("drawn", "drawing"), "move": ("moved", "moving"), "shift": ("shifted", "shifting"),
    "send": ("sent", "sending"), "bring": ("brought", "bringing"), "slide": ("slid", "sliding"),
    "shunt": ("shunted", "shunting"), "haul": ("hauled", "hauling"),
    "tow": ("towed", "towing"), "lug": ("lugged", "lugging"), "trail": ("trailed", "trailing"),
    "fell": ("felled", "felling"), "slant": ("slanted", "slanting"),
    "incline": ("inclined", "inclining"), "uplift": ("uplifted", "uplifting"),
    "skate": ("skated", "skating"),
    "situate": ("situated", "situating"), "plop": ("plopped", "plopping"),
    "plonk": ("plonked", "plonking"), "maneuver": ("maneuvered", "maneuvering"),
    "manoeuvre": ("manoeuvred", "manoeuvring"),
    "relocate": ("relocated", "relocating"), "reposition": ("repositioned", "repositioning"),
    "displace": ("displaced", "displacing"), "transfer": ("transferred", "transferring"),
    "transport": ("transported", "transporting"), "convey": ("conveyed", "conveying"),
    "glide": ("glided", "gliding"), "skid": ("skidded", "skidding"),
    "swivel": ("swivelled", "swivelling"), "pivot": ("pivoted", "pivoting"),
    "revolve": ("revolved", "revolving"), "twirl": ("twirled", "twirling"),
    "bowl": ("bowled", "bowling"), "overturn": ("overturned", "overturning"),
    "upset": ("upset", "upsetting"), "upend": ("upended", "upending"),
    "tumble": ("tumbled", "tumbling"), "hoist": ("hoisted", "hoisting"),
    "elevate": ("elevated", "elevating"), "heave": ("heaved", "heaving"),
    "topple": ("toppled", "toppling"), "tip": ("tipped", "tipping"),
    "knock": ("knocked", "knocking"), "turn": ("turned", "turning"),
    "rotate": ("rotated", "rotating"), "spin": ("spun", "spinning"),
    "twist": ("twisted", "twisting"), "tilt": ("tilted", "tilting"), "lean": ("leaned", "leaning"),
    "lift": ("lifted", "lifting"), "raise": ("raised", "raising"), "pick": ("picked", "picking"),
    "lay": ("laid", "laying"),
    "put": ("put", "putting"), "place": ("placed", "placing"), "set": ("set", "setting"),
    "stand": ("stood", "standing"), "open": ("opened", "opening"), "close": ("closed", "closing"),
    "shut": ("shut", "shutting"), "pour": ("poured", "pouring"), "empty": ("emptied", "emptying"),
    "give": ("given", "giving"), "hand": ("handed", "handing"), "pass": ("passed", "passing"),
    "fill": ("filled", "filling"), "grab": ("grabbed", "grabbing"),
    "grasp": ("grasped", "grasping"), "hold": ("held", "holding"), "take": ("taken", "taking"),
    "remove": ("removed", "removing"), "screw": ("screwed", "screwing"),
    "unscrew": ("unscrewed", "unscrewing"), "explore": ("explored", "exploring"),
    "weigh": ("weighed", "weighing"), "fetch": ("fetched", "fetching"), "get": ("got", "getting"),
    "grip": ("gripped", "gripping"), "seize": ("seized", "seizing"),
    "clutch": ("clutched", "clutching"), "catch": ("caught", "catching"),
    "swing": ("swung", "swinging"), "seal": ("sealed", "sealing"),
    "uncover": ("uncovered", "uncovering"), "uncap": ("uncapped", "uncapping"),
    "hang": ("hung", "hanging"), "leave": ("left", "leaving"),
    "uncork": ("uncorked", "uncorking"), "unseal": ("unsealed", "unsealing"),
    "propel": ("propelled", "propelling"), "impel": ("impelled", "impelling"),
    "thrust": ("thrust", "thrusting"),
    "yank": ("yanked", "yanking"), "slip": ("slipped", "slipping"),
    "reorient": ("reoriented", "reorienting"),
    "capsize": ("capsized", "capsizing"), "swap": ("swapped", "swapping"),
    "switch": ("switched", "switching"), "insert": ("inserted", "inserting"),
    "deposit": ("deposited", "depositing"), "position": ("positioned", "positioning"),
    "cover": ("covered", "covering"),
    "exchange": ("exchanged", "exchanging"), "interchange": ("interchanged", "interchanging"),
    "align": ("aligned", "aligning"), "straighten": ("straightened", "straightening"),
    "square": ("squared", "squaring"), "line": ("lined", "lining"),
    "arrange": ("arranged", "arranging"), "clear": ("cleared", "clearing"),
    "stack": ("stacked", "stacking"), "pile": ("piled", "piling"),
    "tug": ("tugged", "tugging"), "steer": ("steered", "steering"),
    "scoot": ("scooted", "scooting"), "scooch": ("scooched", "scooching"),
    "budge": ("budged", "budging"), "shuffle": ("shuffled", "shuffling"),
    "guide": ("guided", "guiding"),
    "skim": ("skimmed", "skimming"), "whirl": ("whirled", "whirling"),
    "scoop": ("scooped", "scooping"), "jack": ("jacked", "jacking"),
    "lower": ("lowered", "lowering"), "pack": ("packed", "packing"),
    "pop": ("popped", "popping"),
    "stick": ("stuck", "sticking"), "bung": ("bunged", "bunging"),
}  # fmt: skip
"""Participle and gerund of every verb, from the dictionary."""


def test_participles_and_gerunds_are_those_of_the_dictionary() -> None:
    verbs, participles, gerunds = (LEXICON.verb_words[name] for name in NAME_TERMINALS)
    assert set(verbs) == FORMS.keys()
    assert participles == {participle: verb for verb, (participle, _) in FORMS.items()}
    assert gerunds == {gerund: verb for verb, (_, gerund) in FORMS.items()}


def test_verb_and_particle_mean_something_else_than_the_verb() -> None:
    turn, over = LEXICON.find_verb("turn"), LEXICON.find_verb("turn", "over")
    assert turn is not None
    assert over is not None
    assert (turn.goal, over.goal) == ("rotate", "topple")
    assert LEXICON.find_verb("knock") is None
    assert LEXICON.find_verb("push", "up") is None


def test_adjectives_tell_qualities_of_the_contract() -> None:
    told_by_phrases = {"moved_first", "moved_last"}
    assert set(LEXICON.adjectives.values()) == set(get_args(Quality)) - told_by_phrases


# --- plug-ins ---------------------------------------------------------------------------------


def test_plug_in_adds_words() -> None:
    lexicon = LEXICON.with_words(
        verbs=[{"says": ["shimmy"], "action": "slide", "goal": "displace"}],
        terminals={"DIRECTION": {"left": ["portside"]}},
        adjectives={"red": ["crimson"]},
    )
    (frame,) = Parser(lexicon).parse("shimmy the crimson box portside").frames
    assert frame.action == "slide"
    assert frame.object is not None
    assert (frame.object.qualities, frame.object.noun) == (("red",), "box")
    assert frame.goal.model_dump()["direction"] == "left"
    with pytest.raises(ParseError):
        parse("shimmy the box")
    assert parse("push the crimson box").frames[0].object.qualities == ()  # type: ignore[union-attr]


def test_plug_in_adds_names_whose_words_mean_something_else() -> None:
    # "Hard" is a manner; behind an object it would say how to push.
    with pytest.raises(ParseError):
        parse("push the disk next to hard drive")
    read = Parser(LEXICON.with_words(names=["Hard-Drive"])).parse
    for text in ("push hard drive away", "push the hard drive away", "PUSH THE HARD-DRIVE AWAY"):
        (frame,) = read(text).frames
        assert frame.object is not None
        assert frame.object.text.casefold().replace("-", " ") == "hard drive"
        assert not frame.constraints
        assert frame.goal.model_dump()["direction"] == "away"
    (frame,) = read("push the box hard").frames
    assert [constraint.kind for constraint in frame.constraints] == ["hard"]


def test_plug_in_may_say_again_what_is_known() -> None:
    more = {"verbs": [{"says": ["push"], "action": "push", "goal": "displace"}]}
    assert LEXICON.with_words(**more) == LEXICON  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("more", "why"),
    [
        ({"verbs": [{"says": ["push"], "action": "pull", "goal": "displace"}]}, "means both"),
        ({"terminals": {"DIRECTION": {"away": ["left"]}}}, "means both"),
        ({"terminals": {"DIRECTION": {"away": ["up top"], "left": ["up top"]}}}, "means both"),
        ({"terminals": {"COLOUR": {"red": ["red"]}}}, "no terminal is called COLOUR"),
        ({"adjectives": {"blue": ["red"]}}, "means both"),
        ({"adjectives": {"loud": ["loud"]}}, "not told apart by loud"),
    ],
)
def test_plug_in_cannot_change_meanings(more: dict[str, Any], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        LEXICON.with_words(**more)


def test_stored_words_are_those_of_the_file() -> None:
    assert json.loads(STORED.read_text(encoding="utf-8")) == words_data(WORDS.read_bytes())


@pytest.mark.parametrize("content", ["", "no JSON", json.dumps({"digest": "of other words"})])
def test_stored_words_of_another_file_are_not_used(
    content: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = tmp_path / "lexicon.json"
    other.write_text(content, encoding="utf-8")
    monkeypatch.setattr(module, "STORED", other)
    assert default_lexicon.__wrapped__() == LEXICON


def test_first_sentence_needs_neither_yaml_nor_lark() -> None:
    said = "import sys, grammar; grammar.parse('push the box away'); print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", said], capture_output=True, text=True, timeout=PATIENCE, check=True
    )
    assert not {"yaml", "lark"} & set(done.stdout.split())


def test_changed_words_are_read_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    changed = tmp_path / "lexicon.yaml"
    words = WORDS.read_text(encoding="utf-8").replace("nudge", "jiggle")
    changed.write_text(words, encoding="utf-8")
    monkeypatch.setattr(module, "WORDS", changed)
    assert {"nudge", "jiggle"} & default_lexicon.__wrapped__().verbs.keys() == {"jiggle"}


def test_no_key_of_the_words_stands_twice() -> None:
    twice = list[object]()

    class Strict(yaml.SafeLoader):
        """Takes note of keys that stand twice, of which YAML keeps the last."""

    def mapping(loader: yaml.SafeLoader, node: yaml.MappingNode) -> dict[Hashable, object]:
        keys = [loader.construct_object(key) for key, _ in node.value]
        twice.extend(key for key, count in Counter(keys).items() if count > 1)
        return loader.construct_mapping(node, deep=True)

    Strict.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, mapping)
    yaml.load(WORDS.read_bytes(), Loader=Strict)
    assert not twice
