"""Interruptions are never lost, not even those that arrive while a kernel is being compiled."""

from __future__ import annotations

import os
import signal
import threading

import pytest

from cases.interrupt import interruptible


def compiler_that(action):
    """A function that Python takes for a part of the compiler."""
    scope = {"__name__": "numba.core.pretended", "action": action}
    exec("def compile():\n    action()\n    return 'compiled'\n", scope)
    return scope["compile"]


def send(number):
    os.kill(os.getpid(), number)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_stops_at_once(number):
    with pytest.raises(KeyboardInterrupt), interruptible():
        send(number)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_during_compilation_stops_at_the_next_report(number):
    seen = []
    with interruptible() as interruption:
        progress = interruption.watch(seen.append)
        progress("first")
        assert compiler_that(lambda: send(number))() == "compiled"
        with pytest.raises(KeyboardInterrupt):
            progress("second")
    assert seen == ["first"]


def test_signal_that_a_callback_swallowed_stops_at_the_next_report():
    with interruptible() as interruption:
        with pytest.raises(KeyboardInterrupt):
            send(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            interruption.watch(None)("report")


def test_second_signal_does_not_wait_for_the_compiler():
    with interruptible():
        compiler_that(lambda: send(signal.SIGINT))()
        with pytest.raises(KeyboardInterrupt):
            compiler_that(lambda: send(signal.SIGINT))()


def test_ignored_signal_stays_ignored_and_handlers_are_given_back():
    before = signal.getsignal(signal.SIGTERM)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with interruptible() as interruption:
            send(signal.SIGTERM)
            assert not interruption.asked
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGTERM, before)
    ours = signal.getsignal(signal.SIGINT)
    with interruptible():
        assert signal.getsignal(signal.SIGINT) is not ours
    assert signal.getsignal(signal.SIGINT) is ours


def test_other_threads_run_without_listening():
    failures = []

    def work():
        try:
            with interruptible() as interruption:
                interruption.check()
        except BaseException as error:
            failures.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert failures == []
