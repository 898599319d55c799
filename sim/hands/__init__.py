"""Postures of hands: the protocol that planning and control know, and a folder for each hand.

`hand_model` holds the protocol and its values, `mount` where arm and hand are.
"""
