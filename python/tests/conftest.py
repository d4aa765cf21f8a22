import pathlib
import signal
import sys

# A shell starts what runs in its background with SIGINT ignored; the tests of Ctrl-C need Python's own handler.
signal.signal(signal.SIGINT, signal.default_int_handler)

sys.path.insert(0, str(pathlib.Path(__file__).parent))  # the helpers beside the tests
