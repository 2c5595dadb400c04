"""Interruption, exceptions of callbacks, threads."""

import os
import signal
import subprocess
import sys
import threading
import time

import hmax
import numpy as np
import pytest
from conftest import spring_chain

STRUCTURE = spring_chain(50)[:2]


def forever():
    return hmax.integrate("rk4", lambda t, y: -y, [1.0], 1e6, h=1e-2, every=1e5)


def forever_without_bytecode():
    # The right-hand side is a function of C: the interpreter looks for no signals there.
    return hmax.integrate("rk4", np.arctan2, [1.0], 1e6, h=1e-2, every=1e5)


LONG_CALLS = {
    "rhs": forever,
    "rhs of C": forever_without_bytecode,
    "structure": lambda: hmax.integrate("rk4", K=STRUCTURE[0], M=STRUCTURE[1], y0=np.zeros(100), t_end=1e5, h=1e-3, every=1e4),
    "eigenvalues": lambda: hmax.largest_stable_step("rk4", J=np.random.default_rng(1).standard_normal((1500, 1500))),
    "probe": lambda: hmax.probe(lambda y, h: (time.sleep(0.001), y / (1 + h))[1], np.zeros(300), 1e-3, 1),
    "advise": lambda: hmax.advise(hmax.Body("liver", "fem_green"), rate=1000),
}


@pytest.mark.parametrize("name", list(LONG_CALLS))
def test_an_interrupt_ends_a_long_call_within_a_second(name):
    timer = threading.Timer(0.7, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        LONG_CALLS[name]()
    assert time.monotonic() - begin < 0.7 + 3  # a second, and more for machines that are busy
    timer.join()


def test_a_process_ends_while_interrupted_work_goes_on():
    script = """
import os, signal, sys, threading
import hmax, numpy as np
J = np.random.default_rng(1).standard_normal((1800, 1800))
try:
    threading.Timer(1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    hmax.largest_stable_step("rk4", J=J)
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(7)
"""
    done = subprocess.run([sys.executable, "-c", script], check=False, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (7, "interrupted\n", "")


class Peculiar(Exception):
    pass


@pytest.mark.parametrize("method", ["rk4", "ode45", "radau_iia_5", "ode113", "implicit_euler", "cvode_bdf", "odeint_rosenbrock4"])
def test_exceptions_of_a_right_hand_side_come_back_unchanged(method):
    if method not in {name for row in hmax.methods() for name in [row.id, *row.aliases]}:
        pytest.skip(f"this build has no {method}")
    steps = {"h": 0.01} if method in ("rk4", "implicit_euler") else {"rtol": 1e-6}
    raised = Peculiar("at 0.1")

    def rhs(t, y):
        if t > 0.1:
            raise raised
        return -y

    with pytest.raises(Peculiar) as caught:
        hmax.integrate(method, rhs, [1.0], 1, **steps)
    assert caught.value is raised


def test_exceptions_of_a_jacobian_and_a_step_come_back_unchanged():
    raised = Peculiar()

    def fail(*_):
        raise raised

    with pytest.raises(Peculiar) as caught:
        hmax.integrate("implicit_euler", lambda t, y: -y, [1.0], 1, h=0.1, jacobian=fail)
    assert caught.value is raised
    with pytest.raises(Peculiar):
        hmax.probe(fail, [0.0], 1e-3, 1)
    calls = []

    def later(y, h):
        calls.append(h)
        if len(calls) > 20:
            raise raised
        return y / (1 + h)

    with pytest.raises(Peculiar):
        hmax.probe(later, [0.0], 1e-3, 1)


def test_callbacks_come_from_the_calling_thread():
    seen = set()

    def rhs(t, y):
        seen.add(threading.get_ident())
        return -y

    hmax.integrate("radau_iia_5", rhs, [1.0, 2.0, 3.0], 1, rtol=1e-6)
    assert seen == {threading.get_ident()}


def test_other_threads_run_while_a_call_computes():
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    hmax.largest_stable_step("rk4", J=np.random.default_rng(1).standard_normal((500, 500)))
    hmax.integrate("rk4", K=STRUCTURE[0], M=STRUCTURE[1], y0=np.zeros(100), t_end=100, h=1e-3, every=10)
    took = time.monotonic() - begin
    stop.set()
    thread.join()
    assert len(ticks) > 0.03 * took / 0.005


def test_several_threads_get_their_own_answers():
    answers = {}

    def ask(k):
        rate = 1.0 + k
        run = hmax.integrate("rk4", lambda t, y: -rate * y, [1.0], 1, h=0.01)
        limit = hmax.largest_stable_step("explicit_euler", J=[[-rate]])
        answers[k] = (run.y[-1, 0], limit.h_max)

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k in range(8):
        assert answers[k][0] == pytest.approx(np.exp(-1.0 - k), rel=1e-4)
        assert answers[k][1] == pytest.approx(2 / (1 + k), rel=1e-9)


def test_a_callback_may_call_hmax():
    def rhs(t, y):
        return [-hmax.limits("explicit_euler").real * y[0]]

    run = hmax.integrate("rk4", rhs, [1.0], 0.1, h=0.05)
    assert run.y[-1, 0] == pytest.approx(np.exp(-0.2), rel=1e-4)


# A daemon thread is in each of these calls when the interpreter ends.
CALLS_OF_DAEMONS = [
    "hmax.integrate('rk4', lambda t, y: [y[1], -y[0]], y0=[1, 0], t_end=1e7, h=.1, every=1e6)",
    "hmax.integrate('rk4', K=np.eye(50), M=np.ones(50), y0=np.zeros(100), t_end=1e5, h=1e-3, every=1e4)",
    "hmax.probe(lambda y, h: (time.sleep(.001), y * .9)[1], np.zeros(500), h0=1e-4, h1=1)",
    "hmax.probe(lambda y, h: (time.sleep(.6), y * .9)[1], np.zeros(500), h0=1e-4, h1=1)",
    "hmax.largest_stable_step('rk4', np.eye(900) * 100 + np.random.rand(900, 900), np.ones(900), verify=True)",
    "hmax.advise('fem_green@liver', rate=100)",
]


def test_the_interpreter_ends_quietly_while_daemon_threads_are_in_calls():
    script = f"""
import sys, threading, time
import hmax, numpy as np
for call in [{", ".join("lambda: " + call for call in CALLS_OF_DAEMONS)}]:
    threading.Thread(target=call, daemon=True).start()
time.sleep(0.4)
print("leaving", flush=True)
sys.exit(5)
"""
    for _ in range(4):
        begin = time.monotonic()
        done = subprocess.run([sys.executable, "-c", script], check=False, capture_output=True, text=True, timeout=60)
        assert (done.returncode, done.stdout, done.stderr) == (5, "leaving\n", "")
        assert time.monotonic() - begin < 20
