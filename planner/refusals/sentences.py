"""Every refusal of the planner: its code, the kind of obstacle, its sentence, and what would do.

Sentences name their words and numbers in braces; behind a colon stands how a number is read
(`planner.refusals.refusal_builder`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from planner.types.refusal import RefusalReason


@dataclass(frozen=True)
class Sentence:
    """Words of a refusal.

    Attributes:
        reason: the kind of obstacle.
        text: one plain sentence with the deciding numbers in it.
        instead: what would be possible, as plain phrases.
        capability: what is missing, if the reason is `unsupported`.
    """

    reason: RefusalReason
    text: str
    instead: tuple[str, ...] = ()
    capability: str | None = None


_impossible = partial(Sentence, "impossible")
_out_of_reach = partial(Sentence, "out_of_reach")
_blocked = partial(Sentence, "blocked")
_too_uncertain = partial(Sentence, "too_uncertain")
_out_of_time = partial(Sentence, "out_of_time")
_unsupported = partial(Sentence, "unsupported")

_NO_PLACE = "leave out where to touch it"
_UNREACHED = (
    "{ways:count} ways to push the {object} satisfy the sentence, but the hand does not get "
    "there: {last}"
)
_GIVEN_UP = (
    "the search was given up after {looks:count} pushes of the {object}; {out_of_reach:count} of "
    "them are out of the hand's reach, the first since {last}"
)
_USED_UP = (
    "the search for a plan was given up after {work:count} units of work, all that one plan may "
    "take; {untried:count} more ways to touch the {object} and {untried_strategies:count} other "
    "strategies were not tried"
)
_OFF_TABLE = (
    "the table ends after {room:mm} in that direction; {distance:mm} would push the {object} off it"
)
_IN_WAY = "the {other} stands in the way of the {object} after {free:mm}; {distance:mm} are asked"
_OBLIQUE = (
    "pushing the {object} {direction} would meet {face} at {obliqueness:deg} from square, where "
    "fingertips slip off (up to {largest_obliqueness:deg1} would do)"
)
_PUSH_FORCE = "{doing} the {object} may take {needed_force:N}; {allowed_force:N} "

_ALONE = "the {object} falls by itself beyond {stay_on_base_angle:deg_exact}"

_PUSHES = {
    "not_capable": _unsupported("{message}", capability="{capability}"),
    "not_while": _unsupported(
        "this version of the robot is not capable of {what} while {doing}",
        ("leave that out",),
        "{what} while {doing}",
    ),
    "face_not_clear": _unsupported(
        "the {object} is turned by {turned:deg}, so it is not clear which of its faces is the "
        "{face} one",
        ("say the direction of the push instead of the face",),
        "telling faces of a turned object apart",
    ),
    "contradiction": _impossible("{message}"),
    "too_fast": _impossible("{speed:mm/s} are asked; {what} {most:mm/s}", ("at {most:cm/s}",)),
    "moves_itself": _impossible("the {object} cannot move {way} itself"),
    "never_met": _impossible(
        "the {object} does not come to the {other} in that direction",
        ("push it towards the {other}",),
    ),
    "no_room_at_goal": _impossible("there is no room for the {object} there"),
    "leans_on": _blocked(
        "tilted by {tilt:deg_exact}, the {object} would lean over by {leans_over:mm}; the {other} "
        "leaves it {room:mm}",
        ("tilt it to another side",),
    ),
    "no_return": _impossible("{tilt:deg_exact} are asked, and " + _ALONE),
    "may_not_return": _too_uncertain(
        "{tilt:deg_exact} are asked, and "
        + _ALONE
        + "; with what is known of its centre of mass, it is sure to come back from up to "
        "{sure_return:deg_floor} only, and a tilt may be {tolerance:deg_exact} more than asked"
    ),
    "lies": _unsupported(
        "the {object} lies on {side}; this version of the robot moves only what stands",
        ("set it upright first",),
        "moving an object that lies",
    ),
    "hand_not_free": _blocked(
        "the hand holds the {object}: put it down first", ("put the {object} down",)
    ),
    "no_side": _impossible("the {object} has no {where} that is wide enough for a fingertip"),
    "oblique": _impossible(_OBLIQUE, ("push it {square}",)),
    "oblique_face": _impossible(_OBLIQUE, ("push it {square}", _NO_PLACE)),
    "turn_first": _impossible(
        "none of the {object}'s faces looks that way: it would have to be turned by "
        "{obliqueness:deg} first, and is not turned by touching it {region}",
        ("turn it first", _NO_PLACE),
    ),
    "no_way": _impossible(
        "the {object} has no sides, square to the way and wide enough for a fingertip, along which "
        "it could be pushed there"
    ),
    "off_the_table": _impossible(_OFF_TABLE),
    "off_the_table_so_far": _impossible(_OFF_TABLE, ("up to {room:cm_down} would do",)),
    "in_the_way": _blocked(_IN_WAY, ("push the {other} out of the way first",)),
    "in_the_way_so_far": _blocked(_IN_WAY, ("up to {free:cm_down} would do",)),
    "unlikely_pushes": _too_uncertain(
        "{pushes} pushes are needed, and all of them succeed with a probability of "
        "{probability:share}; {asked_probability:share} is asked",
        ("find out the weight and the friction of the {object} first",),
    ),
    "turn_blocked": _blocked(
        "turning here, the {object} would swing {where}", ("move it away from there first",)
    ),
    "cannot_turn": _impossible(
        "no push on a side of the {object} surely turns it: the finger would slip",
        ("find out the friction of the {object} first",),
    ),
    "turned_by_one": _unsupported(
        "two fingertips side by side keep the {object} from turning; this robot turns objects with "
        "one",
        ("say “with one finger”, or leave it out",),
        "turning an object with two fingers",
    ),
    "falls_off": _impossible(
        "the {object} would fall over the edge of the table", ("topple it to another side",)
    ),
    "falls_on": _blocked(
        "the {object}, {height:mm} high, would fall on the {other}", ("topple it to another side",)
    ),
    "force_not_allowed": _impossible(_PUSH_FORCE + "are allowed", ("allow {needed_force:N_up}",)),
    "force_not_there": _out_of_reach(_PUSH_FORCE + "is what the fingers can give"),
    "too_light": _impossible(
        "the {object} gives way at {needed_force:N} at most, so that no push presses "
        "{min_force:N} on it",
        ("ask for no more than {needed_force:N_down}",),
    ),
    "too_slow": _out_of_time(
        "pushing the {object} over {distance:mm} takes {least_time:s}; {max_time:s} are allowed",
        ("allow {least_time:s_up}",),
    ),
    "several_pushes": _out_of_time(
        "it takes {pushes:count} pushes to bring the {object} there, and the hand must go around "
        "it in between; {max_time:s} are allowed",
        ("leave out how long it may take",),
    ),
    "no_push_reached": _out_of_reach(_UNREACHED, ("another direction",)),
    "pushes_blocked": _blocked(_UNREACHED, ("move the {blocker}",)),
    "work_used_up": _out_of_time(_USED_UP, ("--set most_work={more:count}",)),
    "search_given_up": _out_of_time(_GIVEN_UP, ("another direction",)),
    "search_blocked": _out_of_time(_GIVEN_UP, ("move the {blocker}",)),
}

_LOWEST = "the lowest contact that the fingers reach is {lowest_height:mm}"
_SETTLED = "the {object} does not topple there: "
_NARROW = "the {object} is {width:mm} wide there; "

_CONTACTS = {
    "out_of_fingers_reach": _out_of_reach(
        "the {object} is {size:mm} high; the fingers reach {lowest_height:mm} and more"
    ),
    "region_too_high": _impossible(
        "{region} means {low:mm} or higher; the {object} is {size:mm} high and fingertips find a "
        "place on it up to {highest_height:mm}",
        (_NO_PLACE,),
    ),
    "no_such_contact": _impossible(
        "no contact is {region}: one ends at {highest_asked:mm}, the other starts at "
        "{lowest_asked:mm}",
        (_NO_PLACE,),
    ),
    "region_too_low": _out_of_reach("{region} means up to {high:mm}; " + _LOWEST, (_NO_PLACE,)),
    "too_narrow_for_one": _impossible(_NARROW + "a fingertip needs {needed_width:mm}"),
    "too_narrow_for_two": _impossible(
        _NARROW + "two fingertips need {needed_width:mm}", ("push it with one finger",)
    ),
    "may_not_slide": _too_uncertain(
        "the {object} would not slide for sure: {certain}; " + _LOWEST, ("topple it instead",)
    ),
    "may_not_slide_there": _too_uncertain(
        "{region} means {heights} on the {object}{reached}; pushed there it {verb}, since "
        "{certain}",
        (_NO_PLACE,),
    ),
    "may_not_slide_up_there": _too_uncertain(
        "{region} means {heights} on the {object}{reached}; pushed there it {verb}, since "
        "{certain}",
        ("push it at the bottom", _NO_PLACE),
    ),
    "never_topples": _impossible(
        _SETTLED + "by what is known it slides before it topples, even {highest_height:mm} above "
        "the table"
    ),
    "slides_below": _impossible(
        _SETTLED + "it slides before it topples below {critical_height:mm}, and the highest "
        "contact is {highest_height:mm}"
    ),
    "may_not_topple": _too_uncertain(
        "the {object} should topple when pushed above {critical_height:mm}, but friction and "
        "centre of mass are not known well enough to be sure up to {highest_height:mm}"
    ),
    "not_sure": _too_uncertain(
        "{message}; pushed {at:mm} up it {verb} with a probability of {probability:share}, and "
        "{asked_probability:share} is asked"
    ),
}

_SQUEEZE = "{doing} the {object} needs {needed_force:N} of squeeze with μ {friction:share}; "
_NO_GRASP = "there {are} {number} of {doing} the {object}, but the hand does not get there: {last}"
_NO_ROOM = (
    "the fingers side by side find no room on the {object} between {lowest:mm} and {highest:mm} "
    "above its base"
)
_WEIGH = "find out the weight of the {object} first"
_PUT_DOWN = "put the {object} down, then it may be held otherwise"

_GRASPS = {
    "not_graspable": _unsupported(
        "the model of the {object} does not say where a hand may hold it",
        ("push it", "add a `grasp` block to its model"),
        "holding the {object}",
    ),
    "no_two_sides": _impossible("{part} has no two sides that a hand could hold"),
    "too_wide": _impossible(
        "{part} is {width:mm} wide, the hand opens to {widest:mm}", ("push it",)
    ),
    "too_narrow": _impossible(
        "{part} is {width:mm} wide, the hand closes to {narrowest:mm}", ("push it",)
    ),
    "low_lid": _impossible(
        "the {object}'s lid can be held over {height:mm} of its height, the fingers need "
        "{needed:mm}"
    ),
    "no_such_height": _impossible(
        "the {object} may be held between {lowest:mm} and {highest:mm} above its base, not "
        "{region}",
        ("leave out where to hold it",),
    ),
    "no_room": _impossible(_NO_ROOM),
    "no_room_there": _impossible(_NO_ROOM, ("leave out where to hold it",)),
    "squeeze_not_allowed": _impossible(
        _SQUEEZE + "{allowed_force:N} are allowed", ("allow {needed_force:N_up}",)
    ),
    "bears_no_squeeze": _impossible(_SQUEEZE + "it bears {crush:N}"),
    "squeeze_not_there": _impossible(
        _SQUEEZE + "the fingers have {strongest:N} at {width:mm}", ("push it instead",)
    ),
    "may_slip": _too_uncertain(
        "squeezed with {squeeze:N} the {object} holds with a probability of {probability:share}, "
        "and {asked_probability:share} is asked",
        ("{learn}",),
    ),
    "unlikely_grasp": _too_uncertain(
        "{doing} the {object} succeeds with a probability of {probability:share}, and "
        "{asked_probability:share} is asked",
        (_WEIGH,),
    ),
    "no_grasp_reached": _out_of_reach(_NO_GRASP, ("move it to another place",)),
    "grasps_blocked": _blocked(_NO_GRASP, ("move the {blocker}",)),
    "no_reach_in_hand": _out_of_reach(_NO_GRASP, (_PUT_DOWN,)),
    "blocked_in_hand": _blocked(_NO_GRASP, (_PUT_DOWN,)),
    "holds_nothing": _impossible("the hand holds nothing that could be put down"),
    "is_fixed": _impossible("the {object} is fixed in a holder; {doing} it would tear it out"),
    "forbidden_meanwhile": _impossible("{doing} the {object} {forbidden}"),
    "table_ends": _impossible("{what} cannot be put there: the table ends there"),
    "place_taken": _blocked(
        "{what} cannot be put there: the {other} stands there", ("move the {other} first",)
    ),
}

_ARC = (
    "{doing} the {object} takes {lid_force:N2} at the tab with the lid at {angle:deg}; the "
    "standing {object}, {mass:kg}, {verb} at {limit:N2} there"
)
_PULL = (
    "pulling the lid off the {object} takes {needed:N}; the {object} itself is lifted at {held:N}"
)
_TURN = (
    "turning the cap of the {object} takes {needed:Nm}; the standing {object} turns along at "
    "{held:Nm}"
)
_STAYS = (
    "; it stays with a probability of {probability:share}, and {asked_probability:share} is asked"
)
_HOLDER = "fix it in a holder"
_LOOSE = ("find out how slippery the {object} is first", _HOLDER)

_LIDS = {
    "no_lid": _impossible("the {object} has no lid"),
    "lid_not_seen": _impossible("the lid of the {object} is not seen anywhere"),
    "cap_off": _unsupported(
        "the cap of the {object} is off, and this hand cannot set it on its thread again: it takes "
        "off caps, and closes those that are still on the thread"
    ),
    "flip_not_allowed": _impossible(
        "{doing} the {object} takes up to {needed_force:N} at the tab; {allowed_force:N} are "
        "allowed",
        ("allow {needed_force:N_up}",),
    ),
    "gives_way": _impossible(
        _ARC + "; {reserve:times} as much as the lid takes is asked", (_HOLDER,)
    ),
    "may_give_way": _too_uncertain(
        _ARC
        + "; it opens with a probability of {probability:share}, and {asked_probability:share} is "
        "asked",
        (_WEIGH,),
    ),
    "pulled_along": _impossible(_PULL, (_HOLDER,)),
    "turned_along": _impossible(_TURN, (_HOLDER,)),
    "may_be_pulled_along": _too_uncertain(_PULL + _STAYS, _LOOSE),
    "may_be_turned_along": _too_uncertain(_TURN + _STAYS, _LOOSE),
    "no_room_aside": _blocked(
        "there is no free place near the {object} for its lid, {width:mm} wide",
        ("move something away first",),
    ),
}

_FULL = "{volume:ml} do not fit into the {into}: it has room for {room:ml}"
_SIDE = "as it {holds}, the {object} does not lean to the side of its opening"

_POURS = {
    "into_nothing": _impossible(
        "pouring from the {object} needs something to pour into",
        ("say what it is to be poured into",),
    ),
    "into_itself": _impossible("the {object} cannot be poured into itself"),
    "no_container": _impossible("the {object} is no container"),
    "container_lies": _impossible("the {object} lies on its side", ("set it upright first",)),
    "is_closed": _impossible("the {object} is closed", ("open the {object} first",)),
    "is_empty": _impossible("the {object} is empty"),
    "is_full": _impossible(_FULL),
    "does_not_fit": _impossible(_FULL, ("pour up to {fits:ml_down}",)),
    "all_does_not_fit": _impossible(
        _FULL, ("pour up to {fits:ml_down}, which is all there is to pour",)
    ),
    "not_so_much": _impossible(
        "{volume:ml} are asked; {contents:ml} are in the {object}",
        ("pour up to {contents:ml_down}",),
    ),
    "wrong_side": _impossible(_SIDE),
    "wrong_side_in_hand": _impossible(_SIDE, ("put the {object} down, then pour from it",)),
    "may_spill": _too_uncertain(
        "of {volume:ml} the {into}, with room for {room:ml}, receives {received:ml} and "
        "{spilled:ml} are spilled; that it goes well has a probability of {probability:share}, and "
        "{asked_probability:share} is asked",
        (_WEIGH, "pour less"),
    ),
}

SENTENCES: dict[str, Sentence] = _PUSHES | _CONTACTS | _GRASPS | _LIDS | _POURS
"""Refusals by their code."""
