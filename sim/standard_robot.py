"""The robot of the simulated cells: the one place where its arm and its hand are chosen."""

from __future__ import annotations

from sim.arms.arm_kinematics import ArmKinematics
from sim.arms.lwr.lwr_kinematics import FLANGE, LwrKinematics
from sim.hands.four_finger.four_finger_hand import FourFingerHand
from sim.hands.hand_model import Hand

ARM: ArmKinematics = LwrKinematics()
HAND: Hand = FourFingerHand(wrist=FLANGE)
