"""Lookahead of the lexer: the next word or two that a phrase needs behind it.

Some words mean one thing before a number and another before a name ("up to 5 cm", "up to the mug"),
and some phrases are the beginning of a name ("from the left", "from the left box").
"""

from __future__ import annotations

import re
from collections.abc import Callable

from grammar.words.lexicon import Lexicon
from grammar.words.phrase_places import BEFORE_NUMBERS, WORD, Phrases, stands_at

_PERCENT = re.compile(r"[^ %]+ ?(?:%|percent|per cent)(?= |$)")
_NAMED = re.compile(r" (?:the|my|your|our|its|it|this|that|\")")
_CONTACT = re.compile(r" (?:any )?contact with ")
_ARTICLE = re.compile(r"an? ")
_ONTO = re.compile(r" on(?:to)?(?= |$)")
_BEFORE_QUESTIONS = ("", "FILLER", "TELL", "SEPARATOR")  # what is in it may be asked behind these
_BEFORE_QUANTITIES = ("in", "under", "above", "below")
_ASKED = ("CAN_YOU", "HOW", "HOW_HARD", "HOW_MUCH_DOES", "SEEN", "WHAT_CAN", "WHAT_DID", "WHAT_IF",
          "WHAT_IS", "WHERE", "WHERE_IS", "WHERE_WILL", "WHICH_CAN", "WHICH_IS",
          "WHY")  # fmt: skip
"""Terminals that begin a question."""

_IS = ("is", "are", "gets", "goes")
_TOWARDS = ("TOWARD_REGION", "AWAY_FROM_REGION")
_PLACES = ("RELATION", "BETWEEN", "REGION_OF_TABLE", "TO_X", "INTO", "PARTICLE")
_WHERE_TO = ("DIRECTION", *_TOWARDS, *_PLACES)
_BEFORE_PARTICLES = ("VERB", "WORD", "IT", "QUOTED")
_BEFORE_COMMANDS = ("", "FILLER", "SEPARATOR", "NEXT")
_BEFORE_VERBS = (*_BEFORE_COMMANDS, "CAN_YOU", "POSSIBLE", "MANNER", "NO", "YOU")
_AMOUNTS = ("FORCE_UNIT", "SPEED_UNIT", "LENGTH_UNIT")
_TOWARDS_WAY = re.compile(r"(?<![^ ])(?:towards?|away from)(?= |$)")
_LINE = re.compile(r" the (?:[^ ]+ )?(?:edge|side|border|line|left|right)(?= |$)")
_IS_THE = re.compile(r"(?: [^ ,.;]+){1,4}? (?:is|are) (?:the )?")
_NAMES_BEGIN = re.compile(r" (?:the|a|an|my|your|its) ")

Rule = Callable[[str, str, int, str], bool]


class Lookahead:
    """The rules, by terminal, for a lexicon and its phrases."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases) -> None:
        self._any, self._one_of = phrases.has_terminal_at, phrases.has_any_at
        self._follows = phrases.has_any_in_clause
        self._at = phrases.phrases_at
        self._from_sides = lexicon.phrases_of("FROM_SIDE")
        self._first_of_number = lexicon.numbers.first_words
        self._adjectives = lexicon.adjectives
        self._nobodies = lexicon.nobodies
        self._function_words = lexicon.reserved_words | lexicon.first_words
        self._determiners = {p for n in ("THE", "A", "THAT", "IT") for p in lexicon.phrases_of(n)}
        self._verbs, self._last_goal = phrases.verbs, phrases.last_goal
        self._rules = self._rules_of_actions() | self._rules_of_places() | self._rules_of_things()

    def _rules_of_actions(self) -> dict[str, Rule]:
        """Of what is to be done, when and how."""
        return {
            "CAUSE": self._makes_it_happen,
            "DOES_NOT": self._no_can,
            "DO": lambda phrase, text, end, _last: phrase != "go" or end == len(text),
            "FILLER": self._before_what_it_fills,
            "AND_WITH": self._and_with_another_thing,
            "STOP": lambda phrase, text, end, _last: (
                end == len(text) or not (phrase.endswith("not") or phrase.startswith("leave"))
            ),
            "LETTING": lambda _phrase, text, end, _last: not _CONTACT.match(text, end),
            "WHICH": self._of_the_most,
            "TO_BE": lambda phrase, text, end, _last: (
                not phrase.endswith(("get", "gets")) or self._any("VERB_ED", text, end + 1)
            ),
            "NEEDS": self._before(("STROKE", "VERB_ING")),
            "WHICH_IS": self._before(("COMPARATIVE", "SUPERLATIVE")),
            "NEXT": lambda phrase, text, end, last: (
                last != "WHAT_DID"
                and not (phrase.endswith("next") and stands_at("to", text, end + 1))
            ),
            "RIGHTS": lambda _phrase, text, end, last: (
                last in _BEFORE_VERBS and bool(_NAMED.match(text, end))  # not "right, the mug"
            ),
            "OR": self._in_a_list,
            "SAME": self._to_another_thing,
            "BE": lambda phrase, text, end, _last: phrase not in _IS or self._done(text, end + 1),
            "EVENT_INFINITIVE": lambda phrase, text, end, _last: (
                not (phrase.startswith("be ") and self._one_of(_WHERE_TO, text, end + 1))
            ),
            "EVENT": lambda phrase, text, end, _last: (
                phrase not in _IS or not self._done(text, end + 1)
            ),
            "MANNER": lambda phrase, text, end, _last: (
                not (phrase == "with force" and self._any("BOUND", text, end - len("force")))
            ),
            "STROKE": lambda phrase, text, end, last: (
                last == "NEEDS" or self._last_goal(text, end - len(phrase)) == "hand_over"
            ),
            "KEEP": lambda phrase, text, end, _last: (
                phrase != "leave"
                or self._begins_a_number(text, end + 1)
                or self._follows(("KEPT",), text, end)
            ),
            "TO_DO": self._for_something,
            "USING": lambda _phrase, text, end, last: (
                last in _BEFORE_COMMANDS and not self._follows(("TOOL", *_AMOUNTS), text, end)
            ),
            **dict.fromkeys(
                ("COMPARED", "COMPARATIVE"),
                lambda phrase, text, end, _last: phrase != "lower" or not _NAMED.match(text, end),
            ),
            **dict.fromkeys(("NOT", "WHY_DID"), lambda _phrase, text, end, _last: end < len(text)),
        }

    def _rules_of_places(self) -> dict[str, Rule]:
        """Of places and directions."""
        return {
            **dict.fromkeys(("REGION", "FACE", "SIDE_QUALITY"), self._not_into_a_name),
            "REGION_OF_TABLE": lambda phrase, text, end, _last: (
                phrase.rsplit(maxsplit=1)[-1] not in self._adjectives or self._ends_name(text, end)
            ),
            **dict.fromkeys(_TOWARDS, self._not_towards_a_name),
            "DIRECTION": self._no_name_nor_more,
            "UPON": self._onto_what_is_pushed,
            "ON_TABLE": self._put_there,
            "PARTICLE": self._not_off_a_thing,
            "THAT_IS": lambda _phrase, text, end, last: (
                bool(last) and not self._any("COMPARATIVE", text, end + 1)
            ),
            "EXCHANGED_WITH": lambda phrase, text, end, _last: (
                self._last_goal(text, end - len(phrase)) == "swap"
                and self._names_begin(text, end)
                and not self._follows(("TOOL", *_AMOUNTS), text, end)
            ),
            "FROM_SIDE": lambda _phrase, text, end, _last: self._ends_name(text, end),
            "FROM_TABLE": lambda phrase, text, end, last: (
                (last != "LENGTH_UNIT" or phrase.endswith("air"))
                and not (phrase.startswith("up ") and self._last_goal(text, end) is None)
            ),
            "RELATION": self._before_a_thing,
            "TOWARD": self._not_to_make,
            "UNDO": lambda phrase, text, end, _last: (
                not (
                    phrase.endswith("back") and _ONTO.match(text, end)  # put it back on the book
                )
            ),
        }

    def _rules_of_things(self) -> dict[str, Rule]:
        """Of things and amounts."""
        return {
            **dict.fromkeys(BEFORE_NUMBERS, self._before_a_number),
            "AMOUNT": lambda phrase, text, end, _last: (
                not phrase.startswith("a ") or self._ends_name(text, end)  # no little box
            ),
            "CONTENTS": lambda phrase, _text, _end, last: (
                not phrase.startswith("what is") or last not in _BEFORE_QUESTIONS
            ),
            "CUPS": lambda phrase, text, end, _last: (
                self._last_goal(text, end - len(phrase)) in ("pour", "fill")
            ),
            "THE": lambda phrase, text, end, _last: (
                phrase != "its" or not self._any("SIDE_OF_OBJECT", text, end + 1)
            ),
            "EXCEPT": self._behind_several,
            "QUALITY": lambda _phrase, text, end, _last: text[end + 1 : end + 2] in ",.;",
            **dict.fromkeys(
                ("FILLED", "FILLED_WITH"),
                lambda phrase, text, end, _last: self._last_goal(text, end - len(phrase)) == "fill",
            ),
            "OR_MORE": lambda _phrase, text, end, _last: not stands_at("than", text, end + 1),
            "PART_OF": lambda _phrase, _text, _end, last: last == "VOLUME_UNIT",
            "PORTION": self._of_a_liquid,
            "TO_LEVEL": lambda _phrase, text, end, _last: bool(_PERCENT.match(text, end + 1)),
            "LENGTH_UNIT": lambda phrase, text, end, _last: (
                phrase != "in" or not self._begins_a_number(text, end + 1)  # "0.1 in at most 5 s"
            ),
            "OF": lambda _phrase, text, end, _last: bool(_NAMES_BEGIN.match(text, end)),
            "QUANTIFIER": lambda phrase, text, end, last: (
                last not in ("TOUCH", "TOUCHING")
                and self._last_goal(text, end - len(phrase)) not in ("pour", "fill")
            ),
            "SOME_OF": self._some_of_a_liquid,
        }

    def can_be(self, kind: str, phrase: str, text: str, end: int, last: str) -> bool:
        """Check that a phrase of the plain text that ends here can be of a terminal.

        `last` is the terminal of the token before it.
        """
        rule = self._rules.get(kind)
        return rule is None or rule(phrase, text, end, last)

    def _ends_name(self, text: str, end: int) -> bool:
        """Check that no word of a name follows."""
        follower = WORD.match(text, end + 1)
        word = follower.group() if follower else ""
        return not word[:1].isalpha() or word in self._function_words

    def _begins_a_number(self, text: str, start: int) -> bool:
        match = WORD.match(text, start)
        if match is None:
            return False
        word = match.group()
        return (
            word[0] in "+-.0123456789"
            or word in self._first_of_number
            or word in ("twice", "double")
            or (word == "its" and self._any("SIDE_OF_OBJECT", text, match.end() + 1))
            or self._one_of(("THE_SIDE_OF", "BOUND"), text, start)
        )

    def _begins_a_quantity(self, text: str, start: int) -> bool:
        """Check for a number with a unit, or an article before a unit."""
        article = _ARTICLE.match(text, start)
        if article is None:
            return self._begins_a_number(text, start)
        return any(self._any(unit, text, article.end()) for unit in ("TIME_UNIT", "LENGTH_UNIT"))

    def _before(self, kinds: tuple[str, ...]) -> Rule:
        return lambda _phrase, text, end, _last: self._one_of(kinds, text, end + 1)

    def _of_the_most(self, _phrase: str, text: str, end: int, _last: str) -> bool:
        """Which box is the tallest; but not "which box is behind the mug"."""
        named = _IS_THE.match(text, end)
        return named is not None and self._any("SUPERLATIVE", text, named.end())

    def _before_a_number(self, _phrase: str, text: str, end: int, _last: str) -> bool:
        return self._begins_a_number(text, end + 1)

    def _not_into_a_name(self, phrase: str, text: str, end: int, _last: str) -> bool:
        """On the right, but not on the right bottle; put it on the base is no touch."""
        named = phrase.startswith("on the") and not phrase.endswith(("side", "face"))
        if named and self._wants_a_place(text, end - len(phrase)):
            return False
        if stands_at("side", text, end + 1):
            return False  # "at the front side of the box" is no "at the front"
        return phrase.rsplit(maxsplit=1)[-1] not in self._adjectives or self._ends_name(text, end)

    def _wants_a_place(self, text: str, end: int) -> bool:
        """Check for a verb that puts something somewhere that is not said yet."""
        if self._last_goal(text, end) != "place":
            return False
        words = list(WORD.finditer(text, 0, end))
        verb = max(word.start() for word in words if word.group() in self._verbs)
        behind = [word.start() for word in words if word.start() > verb]
        return not any(self._any(kind, text[:end], i) for i in behind for kind in _PLACES)

    def _not_towards_a_name(self, phrase: str, text: str, end: int, _last: str) -> bool:
        """Towards the left, but not towards the left mug."""
        return not _TOWARDS_WAY.search(phrase) or self._ends_name(text, end)

    def _no_name_nor_more(self, phrase: str, text: str, end: int, last: str) -> bool:
        """Further away from you, but not where a remark begins: that goes on farther."""
        goes_on = phrase.startswith(("further", "farther")) and last in _BEFORE_COMMANDS
        return not goes_on and self._not_towards_a_name(phrase, text, end, last)

    def _for_something(self, _phrase: str, text: str, end: int, _last: str) -> bool:
        """To make it slide; use the handle to open it, but not push it to open it."""
        if self._any("EVENT_INFINITIVE", text, end + 1):
            return True
        held = any(self._any("USING", text, word.start()) for word in WORD.finditer(text, 0, end))
        return held and self._any("VERB", text, end + 1)

    def _behind_several(self, phrase: str, text: str, end: int, last: str) -> bool:
        """All but the red one, not push it, but the jar, nor push a box, but it must not fall."""
        denied = stands_at("it", text, end + 1) and self._any("DOES_NOT", text, end + len(" it "))
        listed = last in ("WORD", "QUANTIFIER") or self._ends_with_name(text, end)
        return not denied and self._names_begin(text, end) and (listed or phrase[-3:] != "but")

    def _ends_with_name(self, text: str, end: int) -> bool:
        name = text[end:].split()[1:]
        told = self._adjectives.keys() | self._nobodies
        return bool(name) and all(w in told or w not in self._function_words for w in name)

    def _no_can(self, phrase: str, text: str, end: int, _last: str) -> bool:
        """It can not topple, but not the soup can not below 3 cm."""
        verbs = ("AVOID", "AVOIDING", "TOUCH")
        return not phrase.startswith("can") or self._one_of(verbs, text, end + 1)

    def _in_a_list(self, phrase: str, text: str, end: int, last: str) -> bool:
        """A comma stands for "or" in "do not tilt, turn or topple it"."""
        return phrase != "," or (last == "AVOID" and self._any("AVOID", text, end + 1))

    def _before_a_thing(self, phrase: str, text: str, end: int, _last: str) -> bool:
        """Over to the mug, in a box, but not away from the left, in a second, above the table."""
        measured = phrase.rpartition(" ")[2] in _BEFORE_QUANTITIES
        if measured and self._begins_a_quantity(text, end + 1):
            return False
        if phrase.endswith(("above", "below")) and stands_at("the table", text, end + 1):
            return False
        if phrase == "over to":
            follower = WORD.match(text, end + 1)
            return follower is not None and follower.group() in self._determiners
        if not phrase.endswith("from"):
            return True
        start = end - len("from")
        return not any(
            stands_at(side, text, start) and self._ends_name(text, start + len(side))
            for side in self._from_sides
        )

    def _not_to_make(self, phrase: str, text: str, end: int, _last: str) -> bool:
        """Closer to the mug, but not closer, to make it tip."""
        to_make = self._any("TO_MAKE", text, end - len("to"))
        purpose = to_make or self._any("EVENT_INFINITIVE", text, end + 1)
        return not (phrase.endswith(" to") and purpose)

    def _before_what_it_fills(self, phrase: str, text: str, end: int, last: str) -> bool:
        """So how heavy is it; go push it; why not push it; move right, the mug a bit away."""
        if phrase.startswith("why not"):
            return self._any("VERB", text, end + 1)
        if phrase == "so":
            return self._one_of(_ASKED, text, end + 1)
        if phrase == "right ,":
            return last == "VERB" and self._follows(_WHERE_TO, text, end)
        if phrase.endswith((" way", " that", " this")) and phrase.count(" ") == 1:
            return self._any("WHY_DID", text, 0)
        if phrase.endswith("quickly"):
            verbs = (self._any("VERB", text, word.start()) for word in WORD.finditer(text, end))
            return last in _BEFORE_COMMANDS and any(verbs)
        return phrase != "go" or self._any("VERB", text, end + 1)

    def _and_with_another_thing(self, _phrase: str, text: str, end: int, last: str) -> bool:
        """And with the mug? But not "and with the hand", nor behind anything else."""
        named = self._names_begin(text, end) and not self._follows(("TOOL", *_AMOUNTS), text, end)
        return not last and named

    def _to_another_thing(self, phrase: str, text: str, end: int, last: str) -> bool:
        """The same to the mug, but not the same, to the left; nor do it with one finger."""
        if phrase.endswith(" do"):
            the = stands_at("the", text, end + 1) and not stands_at("the same", text, end + 1)
            return not last and the
        if phrase.endswith("with") and self._follows(("TOOL", *_AMOUNTS), text, end):
            return False
        ways = ("DIRECTION", "REGION_OF_TABLE")
        return not (phrase.endswith(" to") and self._one_of(ways, text, end - len("to")))

    def _some_of_a_liquid(self, phrase: str, text: str, end: int, last: str) -> bool:
        """A bit of the milk, but not a bit, of its front side; pour some milk, no little box."""
        if phrase.endswith("of"):
            of = end - len("of")
            return not any(
                "FACE" in kinds and self._not_into_a_name(face, text, of + len(face), last)
                for face, kinds in self._at(text, of)
            )
        poured = last == "FILLED_WITH" or (last == "VERB" and self._last_goal(text, end) == "pour")
        return poured and not self._ends_name(text, end)

    def _of_a_liquid(self, phrase: str, text: str, end: int, _last: str) -> bool:
        """A quarter of the milk, but not a quarter of its width; half the milk, but not half 5."""
        poured = self._last_goal(text, end) in ("pour", "fill")
        return poured and (
            phrase.startswith("all") or phrase.endswith("of") or bool(_NAMED.match(text, end))
        )

    def _put_there(self, phrase: str, text: str, end: int, _last: str) -> bool:
        """Put it on the table; is it on the table? But not the box on the table, nor its mat."""
        put = self._last_goal(text, end - len(phrase)) in ("place", "set_down")
        put = put or self._any("IS_IT", text, 0)
        return put and self._ends_name(text, end)

    def _makes_it_happen(self, phrase: str, text: str, end: int, _last: str) -> bool:
        """Get the mug to slide, get it pushed, but not get the mug from the shelf."""
        starts = [m.start() for m in WORD.finditer(text, end)]
        done = (self._done(text, i) and not self._any("VERB", text, i) for i in starts)
        made = (
            self._any("EVENT_INFINITIVE", text, i + 3) for i in starts if text[i : i + 3] == "to "
        )
        return phrase != "get" or any(done) or any(made)

    def _done(self, text: str, start: int) -> bool:
        left = self._one_of(("DIRECTION", "RELATION"), text, start)  # left of the mug
        return self._any("VERB_ED", text, start) and not left

    def _not_off_a_thing(self, phrase: str, text: str, end: int, last: str) -> bool:
        """Take the lid off, but not off the jar; take off the lid; pull it open, and open it."""
        if phrase in self._verbs and last not in _BEFORE_PARTICLES:
            return False
        if phrase == "along" and self._names_begin(text, end):
            return last == "VERB" and not _LINE.match(text, end)  # not along the edge
        if phrase.endswith("in"):
            return end == len(text) or text[end + 1] in ",.;"
        if not phrase.endswith(("on", "off", "open", "shut", "closed")) or last == "VERB":
            return True
        return self._ends_name(text, end) and not self._names_begin(text, end)

    def _names_begin(self, text: str, end: int) -> bool:
        """Check for an article, a pronoun or a quotation that follows."""
        follower = WORD.match(text, end + 1)
        return follower is not None and (
            follower.group() in self._determiners
            or follower.group()[0] == '"'
            or self._any("WORD", text, end + 1)
        )

    def _onto_what_is_pushed(self, phrase: str, text: str, end: int, _last: str) -> bool:
        """Press on the mug, but not on the left side, nor put on the lid."""
        goal = self._last_goal(text, end - len(phrase))
        return goal in ("displace", "contact") and self._names_begin(text, end)
