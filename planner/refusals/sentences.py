"""Every refusal of the planner: its code, the kind of obstacle, its sentence, and what would do.

Sentences name their words and numbers in braces; behind a colon stands how a number is read
(`planner.refusals.blocked`). What follows a point in a key tells sentences of one code apart.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from planner.types.cure import Cure, change, first, move, up_to
from planner.types.refusal import RefusalReason


@dataclass(frozen=True)
class Sentence:
    """Words of a refusal.

    Attributes:
        reason: the kind of obstacle.
        text: one plain sentence with the deciding numbers in it.
        cures: what would do instead.
        capability: what is missing, if the reason is `unsupported`.
    """

    reason: RefusalReason
    text: str
    cures: tuple[Cure, ...]
    capability: str | None = None


def _row(
    reason: RefusalReason, text: str, instead: tuple[Cure | str, ...], capability: str | None = None
) -> Sentence:
    """A row of the table; a plain phrase of what would do is advice for people."""
    cures = (Cure("advice", each) if isinstance(each, str) else each for each in instead)
    return Sentence(reason, text, tuple(cures), capability)


impossible = partial(_row, "impossible")
out_of_reach = partial(_row, "out_of_reach")
blocked = partial(_row, "blocked")
too_uncertain = partial(_row, "too_uncertain")
out_of_time = partial(_row, "out_of_time")
too_small = partial(_row, "too_small")
unsupported = partial(_row, "unsupported")
leave_out = partial(Cure, "leave_out")
other_way = partial(Cure, "other_way")


_SQUEEZE = "{doing} the {object} needs {needed_force:N} of squeeze with μ {friction:share}; "
_NO_GRASP = "there {are} {number} of {doing} the {object}, but the hand does not get there: {last}"
_NO_ROOM = (
    "the fingers side by side find no room on the {object} between {lowest:mm} and {highest:mm} "
    "above its base"
)
_MAY_SLIP = (
    "squeezed with {squeeze:N} the {object} holds with a probability of {probability:chance}, and "
    "{asked_probability:share} is asked"
)
_WEIGH = first("find out the weight of the {object}")
_PUT_DOWN = first("put the {object} down", "put the {object} down, then it may be held otherwise")
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
_LOOSE = (first("find out how slippery the {object} is"), _HOLDER)
_FULL = "{volume:ml} do not fit into the {into}: it has room for {room:ml}"
_SIDE = "as it {holds}, the {object} does not lean to the side of its opening"
_NO_PLACE = leave_out("leave out where to touch it")
_THAT = leave_out("leave that out")
_EITHER = ("leave one of the two out",)
_SLOWER = (change("at {most:mm/s_down}", "at {most:mm/s_down}"),)
_OTHER_SIDE = other_way("topple it to another side")
_ANOTHER_WAY, _ANOTHER_PLACE = other_way("say another direction"), "say another place"
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
_NO_RETURN = (
    "{tilt:deg_exact} are asked, and the {object} falls by itself beyond "
    "{stay_on_base_angle:deg_exact}"
)
_MAY_NOT_RETURN = (
    _NO_RETURN + "; with what is known of its centre of mass, it is sure to come back from up to "
    "{sure_return:deg_floor} only, and a tilt may be {tolerance:deg_exact} more than asked"
)
_LESS_TILT = up_to("{possible:deg_floor}")
_LEARN_COM = "find out where its centre of mass is first"
_LOWEST = "the lowest contact that the fingers reach is {lowest_height:mm}"
_SETTLED = "the {object} does not topple there: "
_NEVER_TOPPLES = (
    _SETTLED + "by what is known it slides before it topples, even {highest_height:mm} above the "
    "table"
)
_SLIDES_BELOW = (
    _SETTLED + "it slides before it topples below {critical_height:mm}, and the highest contact is "
    "{highest_height:mm}"
)
_MAY_NOT_TOPPLE = (
    "the {object} should topple when pushed above {critical_height:mm}, but friction and centre of "
    "mass are not known well enough to be sure up to {highest_height:mm}"
)
_OVER_TABLE = ("push the {object} over the table instead",)
_HIGHER = change("push it at the top", "at the top")
_NARROW = "the {object} is {width:mm} wide there; "

SENTENCES: dict[str, Sentence] = {
    # Pushes
    "not_capable": unsupported(
        "this version of the robot is not capable of {what}", (_THAT,), "{what}"
    ),
    "not_capable.command": unsupported(
        "only a command about an object is planned", (_THAT,), "planning what is no command"
    ),
    "not_capable.controller": unsupported(
        "this version of the robot has no controller for {what}",
        ("push, turn, tilt or topple it",),
        "{what}",
    ),
    "not_capable.event": unsupported(
        "the event needs an object that the way leads to",
        (_THAT,),
        "stopping at the event '{event}'",
    ),
    "not_capable.fall": unsupported(
        "this version is not capable of toppling until '{event}'",
        (_THAT,),
        "toppling until '{event}'",
    ),
    "not_capable.place": unsupported("pushes move objects over the table only", (_THAT,), "{what}"),
    "not_capable.top_face": unsupported(
        "a fingertip on the top face draws an object along, over a distance or to a place; it does "
        "nothing else there",
        ("say “at the top” for the upper third of a side face",),
        "pushing on the top face",
    ),
    "not_capable.press": unsupported(
        "questions are answered about pushes on side faces; the top face is not one",
        ("say “at the top” for the upper third of a side face",),
        "predicting presses on the top face",
    ),
    "not_capable.tool": unsupported(
        "this robot pushes with its fingertips, not with the {tool}",
        ("say “with one finger” or “with two fingers”",),
        "pushing with the {tool}",
    ),
    "not_capable.fingers": unsupported(
        "this robot pushes with one or two fingertips", (_THAT,), "pushing with {count} fingers"
    ),
    "not_capable.left": unsupported(
        "this robot has one hand, a right one",
        (leave_out("leave out which hand, or say the right one"),),
        "a second (left) hand",
    ),
    "not_capable.way_of_fall": unsupported(
        "this version does not limit how far an object moves while it topples",
        (_THAT,),
        "limiting how far a toppling object moves",
    ),
    "not_while": unsupported(
        "this version of the robot is not capable of {what} while {doing}",
        (_THAT,),
        "{what} while {doing}",
    ),
    "face_not_clear": unsupported(
        "the {object} is turned by {turned:deg}, so it is not clear which of its faces is the "
        "{face} one",
        ("say the direction of the push instead of the face",),
        "telling faces of a turned object apart",
    ),
    "contradiction.base": impossible("it cannot topple and stay on its base", _EITHER),
    "contradiction.tilt": impossible(
        "{tilt:deg} are asked, but {most:deg} are the most that is allowed", _EITHER
    ),
    "contradiction.slide": impossible("it cannot move over the table and not slide", _EITHER),
    "contradiction.heading": impossible("it cannot turn and keep its heading", _EITHER),
    "contradiction.fall_spills": impossible(
        "the {object} begins to spill at {spill_angle:deg}; toppling tilts it further", _EITHER
    ),
    "contradiction.tilt_spills": impossible(
        "the {object} begins to spill at {spill_angle:deg}; {tilt:deg} are asked", _EITHER
    ),
    "contradiction.touch": impossible("it cannot touch the {other} and not touch it", _EITHER),
    "contradiction.distance": impossible(
        "{distance:mm} are to be moved, but {max_distance:mm} are the most that is allowed", _EITHER
    ),
    "too_fast": impossible(
        "{speed:mm/s} are asked; objects keep to the fingertips up to {most:mm/s}", _SLOWER
    ),
    "too_fast.short": impossible(
        "{speed:mm/s} are asked; over {length:mm} the fingertips come to {most:mm/s}", _SLOWER
    ),
    "too_fast.weak": impossible(
        "{speed:mm/s} are asked; with at most {force_limit:N2} the fingertips keep {most:mm/s}",
        _SLOWER,
    ),
    "too_fast.held": impossible(
        "{speed:mm/s} are asked; what is held is {moved} at up to {most:mm/s}", _SLOWER
    ),
    "too_small": too_small(
        "{amount} cannot be told from nothing; {least} is the least that can",
        (change("{least} or more would do", "{least}"),),
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
        (change("push it towards the {other}", "towards the {other}"),),
    ),
    "no_room_at_goal": impossible("there is no room for the {object} there", (_ANOTHER_PLACE,)),
    "leans_on": blocked(
        "tilted by {tilt:deg_exact}, the {object} would lean over by {leans_over:mm}; the {other} "
        "leaves it {room:mm}",
        (other_way("tilt it to another side"),),
    ),
    "no_return": impossible(
        _NO_RETURN,
        (
            change(
                "tilt it by less than {stay_on_base_angle:deg_exact}",
                "by less than {stay_on_base_angle:deg_exact}",
            ),
            "topple it",
        ),
    ),
    "no_return.less": impossible(_NO_RETURN, (_LESS_TILT,)),
    "may_not_return": too_uncertain(_MAY_NOT_RETURN, (_LEARN_COM,)),
    "may_not_return.less": too_uncertain(_MAY_NOT_RETURN, (_LESS_TILT, _LEARN_COM)),
    "lies": unsupported(
        "the {object} lies on {side}; {doing} it takes that it stands",
        (first("set the {object} upright"),),
        "{doing} an object that lies",
    ),
    "fell": impossible(
        "the {object} has fallen: it lies on {side} now", (first("set the {object} upright"),)
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
        "the hand holds the {object}: put it down first",
        (first("put the {object} down", "put the {object} down"),),
    ),
    "no_side": impossible(
        "the {object} has no {where} that is wide enough for a fingertip",
        (
            "touch it at another side",
            _NO_PLACE,
        ),
    ),
    "oblique": impossible(_OBLIQUE, (change("push it {square}", "{square}"),)),
    "oblique_face": impossible(_OBLIQUE, (change("push it {square}", "{square}"), _NO_PLACE)),
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
    "off_the_table_so_far": impossible(_OFF_TABLE, (up_to("{room:mm_down}"),)),
    "in_the_way": blocked(_IN_WAY, (move("the {other}"),)),
    "in_the_way_so_far": blocked(_IN_WAY, (up_to("{free:mm_down}"),)),
    "no_way_past": impossible(
        "no way was found for the {object} to its place past the {other}, by which that is told",
        (_ANOTHER_PLACE,),
    ),
    "unlikely_pushes": too_uncertain(
        "{pushes} pushes are needed, and all of them succeed with a probability of "
        "{probability:chance}; {asked_probability:share} is asked",
        (first("find out the weight and the friction of the {object}"),),
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
        (up_to("{most:mm_down}"),),
    ),
    "pushed_over_edge": impossible(
        "over the table's edge the {object} is drawn by a fingertip on its top, not pushed on its "
        "{face} side",
        (leave_out("leave out where to touch it"),),
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
        (first("find out how slippery the {object} is"),),
    ),
    "turn_blocked": blocked(
        "turning here, the {object} would swing {where}", ("move it away from there first",)
    ),
    "cannot_turn": impossible(
        "no push on a side of the {object} surely turns it: the finger would slip",
        (first("find out the friction of the {object}"),),
    ),
    "turned_by_one": unsupported(
        "two fingertips side by side keep the {object} from turning; this robot turns objects with "
        "one",
        (change("say “with one finger”, or leave it out", "with one finger"),),
        "turning an object with two fingers",
    ),
    "falls_off": impossible(
        "the {object} would fall over the edge of the table",
        (other_way("topple it to another side"),),
    ),
    "falls_on": blocked(
        "the {object}, {height:mm} high, would fall on the {other}",
        (other_way("topple it to another side"),),
    ),
    "force_not_allowed": impossible(
        _PUSH_FORCE + "are allowed",
        (change("allow {needed_force:N_up}", "with at most {needed_force:N_up}"),),
    ),
    "force_not_there": out_of_reach(
        _PUSH_FORCE + "is what the fingers can give",
        (
            first("find out the weight and the friction of the {object}"),
            "take something out of it",
        ),
    ),
    "too_light": impossible(
        "the {object} gives way at {needed_force:N} at most, so that no push presses "
        "{min_force:N} on it",
        (
            change(
                "ask for no more than {needed_force:N_down}", "with at least {needed_force:N_down}"
            ),
        ),
    ),
    "too_slow": out_of_time(
        "pushing the {object} over {distance:mm} takes {least_time:s}; {max_time:s} are allowed",
        (change("allow {least_time:s_up}", "in at most {least_time:s_up}"),),
    ),
    "several_pushes": out_of_time(
        "it takes {pushes:count} pushes to bring the {object} there, and the hand must go around "
        "it in between; {max_time:s} are allowed",
        (leave_out("leave out how long it may take"),),
    ),
    "no_push_reached": out_of_reach(_UNREACHED, (other_way("another direction"),)),
    "pushes_blocked": blocked(_UNREACHED, (move("the {blocker}"),)),
    "work_used_up": out_of_time(_USED_UP, ("--set most_work={more:count}",)),
    "search_given_up": out_of_time(_GIVEN_UP, (other_way("another direction"),)),
    "search_blocked": out_of_time(_GIVEN_UP, (move("the {blocker}"),)),
    # Contacts of pushes
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
        _NARROW + "two fingertips need {needed_width:mm}",
        (change("push it with one finger", "with one finger"),),
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
        (change("push it at the bottom", "at the bottom"), _NO_PLACE),
    ),
    "never_topples": impossible(_NEVER_TOPPLES, _OVER_TABLE),
    "never_topples.side": impossible(_NEVER_TOPPLES, (_OTHER_SIDE,)),
    "slides_below": impossible(_SLIDES_BELOW, _OVER_TABLE),
    "slides_below.side": impossible(_SLIDES_BELOW, (_OTHER_SIDE,)),
    "slides_below.higher": impossible(_SLIDES_BELOW, (_HIGHER,)),
    "may_not_topple": too_uncertain(
        _MAY_NOT_TOPPLE,
        (first("find out the friction and the centre of mass of the {object}"),),
    ),
    "may_not_topple.higher": too_uncertain(_MAY_NOT_TOPPLE, (_HIGHER,)),
    # Grasps
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
    "no_room_there": impossible(_NO_ROOM, (leave_out("leave out where to hold it"),)),
    "squeeze_not_allowed": impossible(
        _SQUEEZE + "{allowed_force:N} are allowed",
        (change("allow {needed_force:N_up}", "with at most {needed_force:N_up}"),),
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
    "may_slip.mass": too_uncertain(_MAY_SLIP, (first("find out the weight of the {model}"),)),
    "may_slip.finger_friction": too_uncertain(
        _MAY_SLIP, ("find out how slippery the {model} is to the fingers first",)
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
    "grasps_blocked": blocked(_NO_GRASP, (move("the {blocker}"),)),
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
        (first("take it out of its holder"),),
    ),
    "forbidden_meanwhile": impossible(
        "{doing} the {object} {forbidden}", (leave_out("leave out what forbids it"),)
    ),
    "table_ends": impossible(
        "{what} cannot be put there: the table ends there", ("say another place",)
    ),
    "no_level_top": impossible(
        "the {other} has no level top to stand on", ("put it next to the {other}",)
    ),
    "no_level_top.open": impossible(
        "the {other} has no level top to stand on", ("put it into the {other}",)
    ),
    "not_open": impossible(
        "the {other} is no open box, so that the {object} cannot stand in it",
        ("put it next to the {other}",),
    ),
    "too_long_for_box": impossible(
        "the {object} is {excess:mm} too long or too wide for the {other}, with {room:mm} of room "
        "on each side",
        (first("turn the {object}"), "put it next to the {other}"),
    ),
    "box_is_full": blocked(
        "there is no free place for the {object} in the {box}: the {other} stands there",
        (first("take the {other} out of the {box}"),),
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
        "the {other} stands on the {object}", (first("take the {other} off the {object}"),)
    ),
    "stands_on": blocked(
        "the {object} stands on the {other}", (first("take the {object} off the {other}"),)
    ),
    "contains": blocked(
        "the {other} stands in the {object}", (first("take the {other} out of the {object}"),)
    ),
    "stands_in": blocked(
        "the {object} stands in the {other}", (first("take the {object} out of the {other}"),)
    ),
    "place_taken": blocked(
        "{what} cannot be put there: the {other} stands there", (move("the {other}"),)
    ),
    # Lids
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
        (change("allow {needed_force:N_up}", "with at most {needed_force:N_up}"),),
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
    # Pours
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
    "container_lies": impossible("the {object} lies on its side", (first("set it upright"),)),
    "is_closed": impossible("the {object} is closed", (first("open the {object}"),)),
    "is_empty": impossible("the {object} is empty", ("fill it by hand",)),
    "is_full": impossible(
        _FULL,
        (
            "say another container to pour into",
            first("empty that one"),
        ),
    ),
    "does_not_fit": impossible(
        _FULL, (change("pour up to {surely:ml_down}", "pour {surely:ml_down} of it"),)
    ),
    "all_does_not_fit": impossible(
        _FULL,
        (
            change(
                "pour up to {surely:ml_down}, which is all that is surely there",
                "pour {surely:ml_down} of it",
            ),
        ),
    ),
    "not_so_much": impossible(
        "{volume:ml} are asked; {contents:ml} are in the {object}",
        (change("pour up to {surely:ml_down}", "pour {surely:ml_down} of it"),),
    ),
    "wrong_side": impossible(_SIDE, ("pour from something whose opening is in the middle",)),
    "wrong_side_in_hand": impossible(
        _SIDE,
        (first("put the {object} down", "put the {object} down, then pour from it"),),
    ),
    "may_spill": too_uncertain(
        "of {volume:ml} the {into}, with room for {room:ml}, receives {received:ml} and "
        "{spilled:ml} are spilled; that it goes well has a probability of {probability:chance}, "
        "and {asked_probability:share} is asked",
        (_WEIGH, "pour less"),
    ),
}
"""Refusals by their code."""

REACH: dict[str, str] = {
    "": "",  # of a robot that gives no reason
    "told": "{text}",
    "tried_before": "tried before: {detail}",
    "no_robot": "there is no robot",
    "no_hold": "nothing is held",
    "hold_width": "the hand holds what is {narrowest:in_mm} to {widest:mm} wide",
    "weak_hold": "the hand squeezes with {strength:N} there, and {force:N} are needed",
    "weak_hands": "the hands that get there bear {strength:N}, and the push may need {force:N}",
    "weak_arm": "the arm's joints do not bear {force:N0} there",
    "low_finger": "the finger would touch the table {height:mm} up",
    "low_hand": "the hand would come to {height:mm} over the table",
    "low_tilt": "the {object} would hit the table while it is tilted",
    "hand_hits_table": "the hand would hit the table",
    "hand_hits_object": "the hand would hit the {object} with more than its fingertips",
    "hand_hits_lid": "the hand would hit the {object} with more than a fingertip",
    "hand_hits_beside_lid": "the hand would hit the {other} beside the lid",
    "hand_hits_other": "the hand would hit the {other}",
    "object_hits_other": "the {object} would hit the {other}",
    "open_hand_hits": "the open hand does not get around the {object}",
    "no_way_to_lid": "the arm has no free way to the lid: it would hit the {object} or the table",
    "no_way_to_lid_past": "the arm has no free way to the lid: it would hit the {other}",
    "no_way_to_contact": "the arm has no free way to the contact: it would hit the {object} or the "
    "table",
    "no_way_to_contact_past": "the arm has no free way to the contact: it would hit the {other}",
    "no_way_to_hold": "the arm has no free way to the hand's places: it would hit the {met}",
    "no_way_to_hold_past": "the arm has no free way to the hand's places: it would hit the {other}",
    "hand_out_of_reach": "the arm does not reach along the whole way of the hand",
    "hand_lacks": "the arm does not reach along the whole way of the hand: it lacks {lacks:mm}",
    "push_out_of_reach": "the arm does not reach along the whole way of the push",
    "lid_out_of_reach": "the arm does not reach along the lid of the {object}",
}
"""Why arm and hand do not get there, by the code of the answer; `other` is its blocker."""

_DOUBT = (
    "pushed {at:mm} up it {does} with a probability of {probability:chance}, and "
    "{asked_probability:share} is asked"
)
_TRIED = "({tried_work:count} units of work), which does not prove that there is none"

FACTS: dict[str, Sentence] = {
    "doubt.friction": too_uncertain(_DOUBT, (first("find out how slippery the {model} is"),)),
    "doubt.com": too_uncertain(_DOUBT, (first("find out the centre of mass of the {model}"),)),
    "tried": out_of_reach(
        "none was found among {tried_ways:count} ways of the hand in {tried_postures:count} "
        "postures " + _TRIED,
        (),
    ),
    "tried.ways": out_of_reach(
        "none was found among {tried_ways:count} ways of the hand " + _TRIED, ()
    ),
    "nearer": out_of_reach(
        "{nearer:mm} nearer to the middle of the table, at x {nearest_x:mm}, y {nearest_y:mm}, it "
        "would do",
        ("put it there by hand: x {nearest_x:m}, y {nearest_y:m}",),
    ),
}
"""What a sentence goes on with, and what would do first then."""
