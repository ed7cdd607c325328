"""Progress, stopping, threads."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import BUNNY, cube

import aerate

SLOW = {"min_radius": 0.35, "wall": 0.5, "gap": 0.2}  # seconds of packing


def test_progress_tells_stages_and_shares():
    told = []
    aerate.hollow(BUNNY, min_radius=0.7, gap=0.4, wall=0.8, progress=lambda stage, share: told.append((stage, share)))
    stages = list(dict.fromkeys(stage for stage, _ in told))
    assert stages[:2] == ["load", "inspect"] and "pack" in stages and "check" in stages
    assert all(isinstance(stage, str) and isinstance(share, float) and 0 <= share <= 1 for stage, share in told)
    packing = [share for stage, share in told if stage == "pack"]
    assert packing == sorted(packing) and len(packing) > 2
    for function in (aerate.inspect, aerate.pack):
        told.clear()
        function(BUNNY, progress=lambda *stage: told.append(stage))
        assert told[0] == ("load", 0.0)


class Enough(Exception):
    pass


@pytest.mark.parametrize("at", ["load", "pack", "carve", "check"])
def test_what_progress_raises_stops_the_work_and_leaves_no_file(fresh, at):
    raised = Enough()

    def stop(stage, share):
        if stage == at:
            raise raised

    with pytest.raises(Enough) as caught:
        aerate.hollow(BUNNY, output="result.stl", max_radius=4, progress=stop)
    assert caught.value is raised
    assert list(fresh.iterdir()) == []
    aerate.hollow(BUNNY, output="result.stl", max_radius=4)


def test_other_threads_of_python_go_on():
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        before, began = counted[0], time.monotonic()
        aerate.pack(BUNNY, threads=1, **SLOW)
        seconds, during = time.monotonic() - began, counted[0] - before
    finally:
        stop.set()
        thread.join()
    # With the lock held there would be none but those at the callbacks' pauses.
    assert seconds > 0.3, "too quick to tell"
    assert during > 20 * seconds


def test_two_threads_get_the_results_of_one():
    options = [{"max_radius": 4}, {"process": "sla"}, {"max_radius": 3, "wall": 2}, {"shape": "cells"}]
    expected = [aerate.hollow(BUNNY, **each) for each in options]
    results = [None] * len(options)

    def work(i):
        results[i] = aerate.hollow(BUNNY, progress=lambda stage, share: None, **options[i])

    threads = [threading.Thread(target=work, args=(i,)) for i in range(len(options))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for result, one in zip(results, expected):
        assert np.array_equal(result.vertices, one.vertices) and np.array_equal(result.triangles, one.triangles)


def test_an_error_of_one_thread_is_not_that_of_another():
    errors = []

    def fail(wall):
        try:
            aerate.hollow(cube(), wall=wall)
        except aerate.Error as error:
            errors.append((wall, str(error)))

    threads = [threading.Thread(target=fail, args=(11 + i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    aerate.hollow(cube(), max_radius=4)
    for thread in threads:
        thread.join()
    assert len(errors) == 4 and all(f"wall of {wall} mm" in text for wall, text in errors)


INTERRUPTED = """
import sys, aerate
def tell(stage, share):
    print(stage, flush=True)
try:
    aerate.hollow(sys.argv[1], output="result.stl", progress=tell, min_radius=0.2, wall=0.5, gap=0.2, tolerance=0.02)
except KeyboardInterrupt:
    print("stopped", aerate.inspect(sys.argv[1])["input"]["closed"], flush=True)
    sys.exit(7)
"""


def test_ctrl_c_is_a_keyboard_interrupt(fresh):
    process = subprocess.Popen([sys.executable, "-c", INTERRUPTED, BUNNY], stdout=subprocess.PIPE, text=True)
    while process.stdout.readline() != "pack\n":
        pass
    time.sleep(0.3)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    rest, _ = process.communicate(timeout=60)
    assert rest.splitlines()[-1] == "stopped True" and process.returncode == 7
    assert time.monotonic() - began < 30
    assert os.listdir(fresh) == []


# A thread that Python does not wait for is at work when the program ends.
LEFT = """
import os, sys, threading, aerate
begun = threading.Event()
def work():
    while True:
        aerate.hollow(sys.argv[1], output="result.stl", progress=lambda stage, share: begun.set(), process="sla", threads=1)
threading.Thread(target=work, daemon=True).start()
begun.wait()
threading.Event().wait(float(sys.argv[2]))
if len(sys.argv) > 3:  # a process that is forked has no jobs to wait for
    child = os.fork()
    if child:
        assert os.waitpid(child, 0)[1] == 0
sys.exit(0)
"""


@pytest.mark.parametrize("after", [0, 0.05, 0.4])
def test_a_job_that_is_at_work_at_the_end_is_stopped(fresh, after):
    ended = subprocess.run([sys.executable, "-c", LEFT, BUNNY, str(after)], capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")
    assert [name for name in os.listdir(fresh) if name != "result.stl"] == []


def test_a_process_that_is_forked_ends_by_itself():
    script = "import os, sys, aerate; child = os.fork(); sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) if child else 7)"
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stderr) == (7, "")


def test_the_end_of_a_forked_process_waits_for_nobody(fresh):
    ended = subprocess.run([sys.executable, "-c", LEFT, BUNNY, "0.1", "fork"], capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stderr) == (0, "")


def test_a_sub_interpreter_is_refused():
    interpreters = pytest.importorskip("_xxsubinterpreters")
    script = "import sys, _xxsubinterpreters as x; x.run_string(x.create(), sys.argv[1])"
    within = f"import sys; sys.path = {sys.path!r}; import aerate"
    ended = subprocess.run([sys.executable, "-c", script, within], capture_output=True, text=True, timeout=60)
    assert interpreters.get_main() is not None and ended.returncode == 1
    assert "not in a sub-interpreter" in ended.stderr
