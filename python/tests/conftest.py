import pathlib
import signal
import sys

# A shell starts what runs in its background with SIGINT ignored; the tests of Ctrl-C need Python's own handler.
signal.signal(signal.SIGINT, signal.default_int_handler)

sys.path.insert(0, str(pathlib.Path(__file__).parent))  # the helpers beside the tests

collect_ignore = []
try:
    import torch
except ImportError:
    pass  # the files about torch say so themselves
else:
    if not hasattr(torch, "func"):  # Debian 12's torch is 1.13
        collect_ignore.append("test_torch_func.py")
