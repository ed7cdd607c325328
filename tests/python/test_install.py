"""cmake --install puts the package where an interpreter finds it. AERATE_BUILD is the build tree, CMAKE the program."""

import os
import subprocess
import sys
import sysconfig

import pytest

VERSION = f"python{sys.version_info.major}.{sys.version_info.minor}"
IS_DEBIAN = "deb_system" in sysconfig.get_scheme_names()


@pytest.mark.parametrize(
    "prefix, folder",
    [("own", f"lib/{VERSION}/site-packages"), ("root/usr", "lib/python3/dist-packages" if IS_DEBIAN else f"lib/{VERSION}/site-packages")],
)
def test_the_installed_package_works(fresh, prefix, folder):
    subprocess.run(
        [os.environ["CMAKE"], "--install", os.environ["AERATE_BUILD"], "--prefix", str(fresh / prefix)],
        check=True,
        capture_output=True,
    )
    place = fresh / prefix / folder
    assert {each.suffix for each in (place / "aerate").iterdir()} == {".py", ".pyi", ".so", ".typed"}
    code = "import aerate; print(aerate.__file__, aerate.__version__)"
    environment = dict(os.environ, PYTHONPATH=str(place))
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.split()[0] == str(place / "aerate/__init__.py")
