"""The planning service over HTTP: thin routes, and all that guards them."""
