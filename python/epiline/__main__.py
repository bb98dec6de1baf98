"""The program `epiline`: the command line and the window."""

import signal
import sys

from ._epiline import run


def main() -> int:
    """Run the program with the arguments of the process and return its exit status."""
    # The program ends at Ctrl-C; Python would only note it.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return run(["epiline", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
