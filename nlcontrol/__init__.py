"""The front of nlcontrol: say a sentence, get a predicted, executed and checked action."""
