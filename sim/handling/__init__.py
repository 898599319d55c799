"""The whole hand: what it holds between thumb and fingers, and the ways on which it does so."""
