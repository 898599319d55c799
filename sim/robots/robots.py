"""The robot of the simulated cells: the one place where its arm and its hand are chosen."""

from __future__ import annotations

from sim.robots.arm import ArmKinematics
from sim.robots.four_finger_hand import FourFingerHand
from sim.robots.hand import Hand
from sim.robots.lwr_arm import FLANGE, LwrKinematics

ARM: ArmKinematics = LwrKinematics()
HAND: Hand = FourFingerHand(wrist=FLANGE)
