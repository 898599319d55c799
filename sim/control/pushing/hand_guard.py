"""A guard of the hand: one that steers an object leaves the way that was found free.

Model: on its way the hand keeps clear of everything, as was planned. Once it is aside of that way,
hand and arm are spheres again, and other objects stand where they were seen.

Frames: W is the world.
"""

from __future__ import annotations

from planner.types.world_state import WorldState
from sim.collision.collision_scene import CollisionScene
from sim.motion.arm_configuration import ArmConfiguration
from sim.rotations import Array
from sim.traces.trace import EndReason

ASIDE = 0.004
"""Distance from the planned way within which nothing else is near [m]."""

NEAREST = 0.003
"""Distance from another object at which the hand stops: planned ones are larger [m]."""

_EVERY = 3  # control steps from one look to the next


class HandGuard:
    """Ends a push in which the hand comes too near to what it does not push.

    Args:
        stance: of arm and hand.
        state: where everything was seen.
        pushed: name of what is pushed.
    """

    def __init__(self, stance: ArmConfiguration, state: WorldState, pushed: str) -> None:
        self._stance = stance
        self._scene = CollisionScene.from_state(state, pushed, clearance=NEAREST)
        self._steps = 0

    def end(self, q_arm: Array, aside: float) -> tuple[EndReason, str] | None:
        """Why the push ends now; None if it goes on.

        Args:
            q_arm: commanded angles of the arm, shape (7,) [rad].
            aside: distance of the fingertips from the planned way [m].
        """
        self._steps += 1
        if abs(aside) < ASIDE or self._steps % _EVERY:
            return None
        spheres = self._stance.robot_spheres(q_arm[None])[0]
        for other in self._scene.others_near(spheres):
            if not other.is_clear(spheres, NEAREST):
                return "too_close", f"the hand, steering it, comes near the {other.name}"
        return None
