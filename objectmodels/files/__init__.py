"""Files from outside: limits of what is taken from them, how they are read and written."""
