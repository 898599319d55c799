"""Every refusal of the planner: its code, the kind of obstacle, its sentence, and what would do.

Sentences name their words and numbers in braces; behind a colon stands how a number is read
(`planner.refusals.no_plan`).
"""

from __future__ import annotations

from planner.types.refusal import (
    Sentence,
    blocked,
    impossible,
    out_of_reach,
    out_of_time,
    too_small,
    too_uncertain,
    unsupported,
)

_SQUEEZE = "{doing} the {object} needs {needed_force:N} of squeeze with μ {friction:share}; "
_NO_GRASP = "there {are} {number} of {doing} the {object}, but the hand does not get there: {last}"
_NO_ROOM = (
    "the fingers side by side find no room on the {object} between {lowest:mm} and {highest:mm} "
    "above its base"
)
_WEIGH = "find out the weight of the {object} first"
_PUT_DOWN = "put the {object} down, then it may be held otherwise"

_GRASPS = {
    "no_two_sides": impossible("{part} has no two sides that a hand could hold", ("push it",)),
    "too_wide": impossible(
        "{part} is {width:mm} wide, the hand opens to {widest:mm}", ("push it",)
    ),
    "too_narrow": impossible(
        "{part} is {width:mm} wide, the hand closes to {narrowest:mm}", ("push it",)
    ),
    "low_lid": impossible(
        "the {object}'s lid can be held over {height:mm} of its height, the fingers need "
        "{needed:mm}",
        ("open the {object} yourself",),
    ),
    "no_room": impossible(_NO_ROOM, ("push it",)),
    "no_room_there": impossible(_NO_ROOM, ("leave out where to hold it",)),
    "squeeze_not_allowed": impossible(
        _SQUEEZE + "{allowed_force:N} are allowed", ("allow {needed_force:N_up}",)
    ),
    "bears_no_squeeze": impossible(_SQUEEZE + "it bears {crush:N}", ("push it",)),
    "squeeze_not_there": impossible(
        _SQUEEZE + "the fingers have {strongest:N} at {width:mm}", ("push it instead",)
    ),
    "no_squeeze_holds": impossible(
        "no squeeze holds the {object}: {doing} it takes a friction of {needed_friction:share} and "
        "more at the fingers, and μ is {friction:share}",
        ("push it",),
    ),
    "may_slip": too_uncertain(
        "squeezed with {squeeze:N} the {object} holds with a probability of {probability:chance}, "
        "and {asked_probability:share} is asked",
        ("{learn}",),
    ),
    "hangs_askew": too_uncertain(
        "the {object} would lean by {lean:deg} in the hand, give or take {lean_sd:deg}, and "
        "{upright:deg} are allowed",
        ("push it",),
    ),
    "unlikely_grasp": too_uncertain(
        "{doing} the {object} succeeds with a probability of {probability:chance}, and "
        "{asked_probability:share} is asked",
        (_WEIGH,),
    ),
    "no_grasp_reached": out_of_reach(_NO_GRASP, ("move it to another place",)),
    "grasps_blocked": blocked(_NO_GRASP, ("move the {blocker} first",)),
    "hemmed_in": blocked(
        "the hand does not get to the {object} for all that stands about it; which of that would "
        "have to go was not found",
        ("make room around the {object}",),
    ),
    "no_reach_in_hand": out_of_reach(_NO_GRASP, (_PUT_DOWN,)),
    "blocked_in_hand": blocked(_NO_GRASP, (_PUT_DOWN,)),
    "holds_nothing": impossible(
        "the hand holds nothing that could be put down", ("pick something up",)
    ),
    "is_fixed": impossible(
        "the {object} is fixed in a holder; {doing} it would tear it out",
        ("take it out of its holder first",),
    ),
    "forbidden_meanwhile": impossible(
        "{doing} the {object} {forbidden}", ("leave out what forbids it",)
    ),
    "table_ends": impossible(
        "{what} cannot be put there: the table ends there", ("say another place",)
    ),
    "no_level_top": impossible(
        "the {other} has no level top to stand on", ("put it next to the {other}",)
    ),
    "not_open": impossible(
        "the {other} is no open box, so that the {object} cannot stand in it",
        ("put it next to the {other}",),
    ),
    "too_long_for_box": impossible(
        "the {object} is {excess:mm} too long or too wide for the {other}, with {room:mm} of room "
        "on each side",
        ("turn the {object} first", "put it next to the {other}"),
    ),
    "box_is_full": blocked(
        "there is no free place for the {object} in the {box}: the {other} stands there",
        ("take the {other} out of the {box} first",),
    ),
    "falls_in": impossible(
        "the {object} does not cover the opening of the {other}", ("put it next to the {other}",)
    ),
    "overhangs": impossible(
        "the {object} would not stand on the {other}: a centre of mass would be {beyond:mm} beyond "
        "the edge of what carries it",
        ("put it next to the {other}",),
    ),
    "may_fall_off": too_uncertain(
        "the {object} would stand on the {other} with a probability of {probability:share}, "
        "{margin:mm} from falling, and {asked_probability:share} is asked",
        ("put it next to the {other}",),
    ),
    "carries": blocked(
        "the {other} stands on the {object}", ("take the {other} off the {object} first",)
    ),
    "stands_on": blocked(
        "the {object} stands on the {other}", ("take the {object} off the {other} first",)
    ),
    "contains": blocked(
        "the {other} stands in the {object}", ("take the {other} out of the {object} first",)
    ),
    "stands_in": blocked(
        "the {object} stands in the {other}", ("take the {object} out of the {other} first",)
    ),
    "place_taken": blocked(
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
    "; it stays with a probability of {probability:chance}, and {asked_probability:share} is asked"
)
_HOLDER = "fix it in a holder"
_LOOSE = ("find out how slippery the {object} is first", _HOLDER)

_LIDS = {
    "no_lid": impossible("the {object} has no lid", ("name something with a lid",)),
    "lid_not_seen": impossible(
        "the lid of the {object} is not seen anywhere",
        ("lay the lid on the table, where the camera sees it",),
    ),
    "cap_off": unsupported(
        "the cap of the {object} is off, and this hand cannot set it on its thread again: it takes "
        "off caps, and closes those that are still on the thread",
        ("screw the cap on yourself",),
    ),
    "flip_not_allowed": impossible(
        "{doing} the {object} takes up to {needed_force:N} at the tab; {allowed_force:N} are "
        "allowed",
        ("allow {needed_force:N_up}",),
    ),
    "gives_way": impossible(
        _ARC + "; {reserve:times} as much as the lid takes is asked", (_HOLDER,)
    ),
    "may_give_way": too_uncertain(
        _ARC
        + "; it opens with a probability of {probability:chance}, and {asked_probability:share} is "
        "asked",
        (_WEIGH,),
    ),
    "pulled_along": impossible(_PULL, (_HOLDER,)),
    "turned_along": impossible(_TURN, (_HOLDER,)),
    "may_be_pulled_along": too_uncertain(_PULL + _STAYS, _LOOSE),
    "may_be_turned_along": too_uncertain(_TURN + _STAYS, _LOOSE),
    "no_room_aside": blocked(
        "there is no free place near the {object} for its lid, {width:mm} wide",
        ("move something away first",),
    ),
}

_FULL = "{volume:ml} do not fit into the {into}: it has room for {room:ml}"
_SIDE = "as it {holds}, the {object} does not lean to the side of its opening"

_POURS = {
    "into_nothing": impossible(
        "pouring from the {object} needs something to pour into",
        ("say what it is to be poured into",),
    ),
    "into_itself": impossible(
        "the {object} cannot be poured into itself", ("say another container to pour into",)
    ),
    "no_container": impossible("the {object} is no container", ("name a container",)),
    "hand_from_below": impossible(
        "to stand the {object} up the hand would have to hold it from below",
        ("have somebody stand it up",),
    ),
    "container_lies": impossible("the {object} lies on its side", ("set it upright first",)),
    "is_closed": impossible("the {object} is closed", ("open the {object} first",)),
    "is_empty": impossible("the {object} is empty", ("fill it by hand",)),
    "is_full": impossible(
        _FULL,
        (
            "say another container to pour into",
            "empty that one first",
        ),
    ),
    "does_not_fit": impossible(_FULL, ("pour up to {surely:ml_down}",)),
    "all_does_not_fit": impossible(
        _FULL, ("pour up to {surely:ml_down}, which is all that is surely there",)
    ),
    "not_so_much": impossible(
        "{volume:ml} are asked; {contents:ml} are in the {object}",
        ("pour up to {surely:ml_down}",),
    ),
    "wrong_side": impossible(_SIDE, ("pour from something whose opening is in the middle",)),
    "wrong_side_in_hand": impossible(_SIDE, ("put the {object} down, then pour from it",)),
    "may_spill": too_uncertain(
        "of {volume:ml} the {into}, with room for {room:ml}, receives {received:ml} and "
        "{spilled:ml} are spilled; that it goes well has a probability of {probability:chance}, "
        "and {asked_probability:share} is asked",
        (_WEIGH, "pour less"),
    ),
}

HAND_SENTENCES: dict[str, Sentence] = _GRASPS | _LIDS | _POURS
"""Refusals of what takes the whole hand, by their code."""


_NO_PLACE = "leave out where to touch it"
_ANOTHER_WAY, _ANOTHER_PLACE = "say another direction", "say another place"
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
    "not_capable": unsupported("{message}", ("leave that out",), capability="{capability}"),
    "not_while": unsupported(
        "this version of the robot is not capable of {what} while {doing}",
        ("leave that out",),
        "{what} while {doing}",
    ),
    "face_not_clear": unsupported(
        "the {object} is turned by {turned:deg}, so it is not clear which of its faces is the "
        "{face} one",
        ("say the direction of the push instead of the face",),
        "telling faces of a turned object apart",
    ),
    "contradiction": impossible("{message}", ("leave one of the two out",)),
    "too_fast": impossible("{speed:mm/s} are asked; {what} {most:mm/s}", ("at {most:mm/s_down}",)),
    "too_small": too_small(
        "{amount} cannot be told from nothing; {least} is the least that can",
        ("{least} or more would do",),
    ),
    "moves_itself": impossible("the {object} cannot move {way} itself", (_ANOTHER_WAY,)),
    "place_at_itself": impossible("the place of the {object} is told by itself", (_ANOTHER_PLACE,)),
    "between_one": impossible(
        "a place between takes two objects, not the {other} twice", ("put it next to the {other}",)
    ),
    "no_sides": impossible(
        "the {other} has no sides along which something could lie", ("turn it by an angle",)
    ),
    "never_met": impossible(
        "the {object} does not come to the {other} in that direction",
        ("push it towards the {other}",),
    ),
    "no_room_at_goal": impossible("there is no room for the {object} there", (_ANOTHER_PLACE,)),
    "leans_on": blocked(
        "tilted by {tilt:deg_exact}, the {object} would lean over by {leans_over:mm}; the {other} "
        "leaves it {room:mm}",
        ("tilt it to another side",),
    ),
    "no_return": impossible(
        "{tilt:deg_exact} are asked, and " + _ALONE,
        (
            "tilt it by less than {stay_on_base_angle:deg_exact}",
            "topple it",
        ),
    ),
    "may_not_return": too_uncertain(
        "{tilt:deg_exact} are asked, and "
        + _ALONE
        + "; with what is known of its centre of mass, it is sure to come back from up to "
        "{sure_return:deg_floor} only, and a tilt may be {tolerance:deg_exact} more than asked",
        ("find out the centre of mass of the {object} first",),
    ),
    "lies": unsupported(
        "the {object} lies on {side}; {doing} it takes that it stands",
        ("set the {object} upright first",),
        "{doing} an object that lies",
    ),
    "fell": impossible(
        "the {object} has fallen: it lies on {side} now", ("set the {object} upright first",)
    ),
    "falls_otherwise": impossible(
        "tipped over, the {object} would not come to stand on its bottom",
        ("have somebody stand it up",),
    ),
    "no_edge": impossible(
        "the {object} lies on {side}, which has no edge with its bottom to tip it over",
        ("have somebody stand it up",),
    ),
    "rolls": impossible(
        "the {object} lies on its round side: it would roll, and how far is not predicted",
        ("have somebody set it upright",),
    ),
    "leans": impossible(
        "the {object} lies on nothing flat: how it would move is not predicted",
        ("have somebody set it upright",),
    ),
    "hand_not_free": blocked(
        "the hand holds the {object}: put it down first", ("put the {object} down",)
    ),
    "no_side": impossible(
        "the {object} has no {where} that is wide enough for a fingertip",
        (
            "touch it at another side",
            _NO_PLACE,
        ),
    ),
    "oblique": impossible(_OBLIQUE, ("push it {square}",)),
    "oblique_face": impossible(_OBLIQUE, ("push it {square}", _NO_PLACE)),
    "turn_first": impossible(
        "none of the {object}'s faces looks that way: it would have to be turned by "
        "{obliqueness:deg} first, and is not turned by touching it {region}",
        ("turn it first", _NO_PLACE),
    ),
    "no_way": impossible(
        "the {object} has no sides, square to the way and wide enough for a fingertip, along which "
        "it could be pushed there",
        (_ANOTHER_WAY,),
    ),
    "off_the_table": impossible(_OFF_TABLE, (_ANOTHER_WAY,)),
    "off_the_table_so_far": impossible(_OFF_TABLE, ("up to {room:mm_down} would do",)),
    "in_the_way": blocked(_IN_WAY, ("move the {other} first",)),
    "in_the_way_so_far": blocked(_IN_WAY, ("up to {free:mm_down} would do",)),
    "no_way_past": impossible(
        "no way was found for the {object} to its place past the {other}, by which that is told",
        (_ANOTHER_PLACE,),
    ),
    "unlikely_pushes": too_uncertain(
        "{pushes} pushes are needed, and all of them succeed with a probability of "
        "{probability:chance}; {asked_probability:share} is asked",
        ("find out the weight and the friction of the {object} first",),
    ),
    "drag_turns": unsupported(
        "pressed from above, the {object} is drawn along as it lies; it would have to turn by "
        "{turn:deg}",
        ("turn it first",),
        "turning an object by pressing on it",
    ),
    "no_top_to_press": impossible(
        "the {object} has no level face on top, over its centre of mass, on which a fingertip "
        "could press",
        (_ANOTHER_WAY,),
    ),
    "no_pressing": unsupported(
        "this robot does not press on the {object} from above",
        ("push it on a side",),
        "pressing from above",
    ),
    "drag_tips": impossible(
        "the {object}, {height:mm} high, would tip over if it were drawn along from above",
        ("push it on a side",),
    ),
    "hangs_too_far": impossible(
        "hanging {overhang:mm} over the table's {edge} edge, the {object} would not surely lie "
        "there: its centre of mass has to stay over the table",
        ("up to {most:mm_down} would do",),
    ),
    "pushed_over_edge": impossible(
        "over the table's edge the {object} is drawn by a fingertip on its top, not pushed on its "
        "{face} side",
        ("leave out where to touch it",),
    ),
    "finger_too_smooth": impossible(
        "no pressing from above takes the {object} along: friction at the fingertip is "
        "{finger:share}, at the table {table:share}",
        ("lift the {object}, if a hand can hold it",),
    ),
    "press_too_weak": out_of_reach(
        "drawing the {object} along takes that it is pressed from above with {needed_force:N}; a "
        "fingertip presses with {max_press:N} at most",
        ("lift the {object}, if a hand can hold it",),
    ),
    "drag_slips": too_uncertain(
        "pressed from above with {max_press:N}, all that a fingertip has, the {object} comes along "
        "with a probability of {probability:chance}; {asked_probability:share} is asked, and with "
        "everything as believed {needed_force:N} would do",
        ("find out how slippery the {object} is first",),
    ),
    "turn_blocked": blocked(
        "turning here, the {object} would swing {where}", ("move it away from there first",)
    ),
    "cannot_turn": impossible(
        "no push on a side of the {object} surely turns it: the finger would slip",
        ("find out the friction of the {object} first",),
    ),
    "turned_by_one": unsupported(
        "two fingertips side by side keep the {object} from turning; this robot turns objects with "
        "one",
        ("say “with one finger”, or leave it out",),
        "turning an object with two fingers",
    ),
    "falls_off": impossible(
        "the {object} would fall over the edge of the table", ("topple it to another side",)
    ),
    "falls_on": blocked(
        "the {object}, {height:mm} high, would fall on the {other}", ("topple it to another side",)
    ),
    "force_not_allowed": impossible(_PUSH_FORCE + "are allowed", ("allow {needed_force:N_up}",)),
    "force_not_there": out_of_reach(
        _PUSH_FORCE + "is what the fingers can give",
        (
            "find out the weight and the friction of the {object} first",
            "take something out of it",
        ),
    ),
    "too_light": impossible(
        "the {object} gives way at {needed_force:N} at most, so that no push presses "
        "{min_force:N} on it",
        ("ask for no more than {needed_force:N_down}",),
    ),
    "too_slow": out_of_time(
        "pushing the {object} over {distance:mm} takes {least_time:s}; {max_time:s} are allowed",
        ("allow {least_time:s_up}",),
    ),
    "several_pushes": out_of_time(
        "it takes {pushes:count} pushes to bring the {object} there, and the hand must go around "
        "it in between; {max_time:s} are allowed",
        ("leave out how long it may take",),
    ),
    "no_push_reached": out_of_reach(_UNREACHED, ("another direction",)),
    "pushes_blocked": blocked(_UNREACHED, ("move the {blocker} first",)),
    "work_used_up": out_of_time(_USED_UP, ("--set most_work={more:count}",)),
    "search_given_up": out_of_time(_GIVEN_UP, ("another direction",)),
    "search_blocked": out_of_time(_GIVEN_UP, ("move the {blocker} first",)),
}

_LOWEST = "the lowest contact that the fingers reach is {lowest_height:mm}"
_SETTLED = "the {object} does not topple there: "
_NARROW = "the {object} is {width:mm} wide there; "

_CONTACTS = {
    "out_of_fingers_reach": out_of_reach(
        "the {object} is {size:mm} high; the fingers reach {lowest_height:mm} and more",
        ("lift the {object}, if a hand can hold it",),
    ),
    "region_too_high": impossible(
        "{region} means {low:mm} or higher; the {object} is {size:mm} high and fingertips find a "
        "place on it up to {highest_height:mm}",
        (_NO_PLACE,),
    ),
    "no_such_contact": impossible(
        "no contact is {region}: one ends at {highest_asked:mm}, the other starts at "
        "{lowest_asked:mm}",
        (_NO_PLACE,),
    ),
    "region_too_low": out_of_reach("{region} means up to {high:mm}; " + _LOWEST, (_NO_PLACE,)),
    "too_narrow_for_one": impossible(
        _NARROW + "a fingertip needs {needed_width:mm}",
        (
            "touch it at another side",
            "lift the {object}, if a hand can hold it",
        ),
    ),
    "too_narrow_for_two": impossible(
        _NARROW + "two fingertips need {needed_width:mm}", ("push it with one finger",)
    ),
    "may_not_slide": too_uncertain(
        "the {object} would not slide for sure: {certain}; " + _LOWEST, ("topple it instead",)
    ),
    "may_not_slide_there": too_uncertain(
        "{region} means {heights} on the {object}{reached}; pushed there it {verb}, since "
        "{certain}",
        (_NO_PLACE,),
    ),
    "may_not_slide_up_there": too_uncertain(
        "{region} means {heights} on the {object}{reached}; pushed there it {verb}, since "
        "{certain}",
        ("push it at the bottom", _NO_PLACE),
    ),
    "never_topples": impossible(
        _SETTLED + "by what is known it slides before it topples, even {highest_height:mm} above "
        "the table",
        ("push the {object} over the table instead",),
    ),
    "slides_below": impossible(
        _SETTLED + "it slides before it topples below {critical_height:mm}, and the highest "
        "contact is {highest_height:mm}",
        ("push the {object} over the table instead",),
    ),
    "may_not_topple": too_uncertain(
        "the {object} should topple when pushed above {critical_height:mm}, but friction and "
        "centre of mass are not known well enough to be sure up to {highest_height:mm}",
        ("find out the friction and the centre of mass of the {object} first",),
    ),
    "not_sure": too_uncertain(
        "{message}; pushed {at:mm} up it {verb} with a probability of {probability:chance}, and "
        "{asked_probability:share} is asked",
        ("find out its weight and friction first",),
    ),
}

SENTENCES: dict[str, Sentence] = _PUSHES | _CONTACTS | HAND_SENTENCES
"""Refusals by their code."""
