"""`python -m nlcontrol`, the same as the command `nlcontrol`."""

from nlcontrol.cli import main

if __name__ == "__main__":
    main()
