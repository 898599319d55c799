"""Plans of a whole hand: lift, place, pour, open and close.

From a frame to a grasp and the steps of the hand after it (`planner.types.actions`), whose
predicted outcome satisfies the frame, or to a refusal with its numbers.
"""
