"""run.py FILE...: these tests under pytest; 77 where nothing could be tested, with the reason."""

import sys

sys.dont_write_bytecode = True
try:
    import numpy  # noqa: F401
    import pytest
except ImportError as error:
    print(f"nothing is tested here: {error} (python3-numpy, python3-pytest)")
    sys.exit(77)


class Counted:
    def __init__(self):
        self.passed = 0

    def pytest_runtest_logreport(self, report):
        self.passed += report.when == "call" and report.passed


counted = Counted()
status = pytest.main(["-q", "-rs", "-p", "no:cacheprovider", *sys.argv[1:]], plugins=[counted])
sys.exit(77 if status == 0 and counted.passed == 0 else status)
