import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))  # the helpers beside the tests

collect_ignore = []
try:
    import torch
except ImportError:
    pass  # the files about torch say so themselves
else:
    if not hasattr(torch, "func"):  # Debian 12's torch is 1.13
        collect_ignore.append("test_torch_func.py")
