"""Refusals of grasps, lids and pours; see `planner.refusals.sentences`."""

from __future__ import annotations

from planner.refusals.refusal_sentence import (
    Sentence,
    blocked,
    impossible,
    out_of_reach,
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
