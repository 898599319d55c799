"""The process of the command line: `nlcontrol` and `python -m nlcontrol`."""

from nlcontrol.interruption import SIGNALS


def main() -> None:
    """Runs the command line; signals wait until it is loaded."""
    SIGNALS.hold()
    from nlcontrol.cli import main as run_command_line

    run_command_line()


if __name__ == "__main__":
    main()
