#!/usr/bin/env python3
"""Slow uploads where others wait: for the worker that one holds, for the memory that many take."""
import signal

from contract import *
from family import *
from harness import *
from wire import *

MB = 10 ** 6
BOX = stl(box((0, 0, 0), (40, 30, 20)))


def solid(facets):
    """A binary STL of so many facets: boxes on top of each other."""
    return BOX[:80] + struct.pack("<I", facets) + BOX[84:] * (facets // 12)


LARGE = solid(12 * 1000)  # 0.6 MB


def says(d, text):
    return text in d.get("/readyz?verbose").body


def held(d, w, body):
    """A worker has the upload of ${w}: it came fast, and its end does not come."""
    w.send(post(b"", length=len(body)) + body[:400000])
    return until(lambda: b"masspropd_workers_busy 1" in d.get("/metrics").body)


def test_slow_alone(d):
    with Wire(d.port, 30) as w:
        check("an upload that began fast has a worker", held(d, w, LARGE))
        for at in range(400000, 560000, 20000):  # 0.1 MB a second for 8 seconds
            w.send(LARGE[at:at + 20000])
            time.sleep(1)
        w.send(LARGE[560000:])
        a = w.one()
        check("who comes slowly while nobody waits is served", a and a.status == 200, a)


def test_slow_in_company(d):
    """The crowd's rule: 1 MB a second over 5 seconds, from whoever holds a worker then."""
    with Wire(d.port, 30) as slow, Wire(d.port, 60) as other:
        check("an upload that began fast has the worker", held(d, slow, LARGE))
        other.send(post(LARGE))
        check("another one waits for it", until(lambda: says(d, b"1 large")))
        at = 400000
        while at < 600000 and not replies(slow.data) and slow.send(LARGE[at:at + 5000]):
            at += 5000
            slow.socket.settimeout(0.5)
            slow._more()
        a = slow.one()
        check("who comes slowly while others wait: 408", a and not problem_faults(
            a, 408, "too_slow"), a)
        check("and the connection ends", slow.ends())
        a = other.one()
        check("the other one has its turn", a and a.status == 200, a)


def test_memory_full():
    """16 MB may wait.  Bodies whose beginning comes slowly are collected while the worker is busy."""
    big = solid(12 * 15000)  # 9 MB
    with Daemon("--workers", "1", "--memory", "64MB", "--deadline", "120s") as d:
        kill(workers(d.pid)[0], sig=signal.SIGSTOP)
        with Wire(d.port) as first, Wire(d.port, 30) as a, Wire(d.port, 30) as b:
            first.send(post(LARGE))
            check("the worker is busy",
                  until(lambda: b"masspropd_workers_busy 1" in d.get("/metrics").body))
            for w in (a, b):
                w.send(post(b"", length=len(big)) + big[:100000])
            time.sleep(0.5)
            for w in (a, b):
                w.send(big[100000:-1])
            b.send(big[-1:])
            answer = b.one()
            check("a body that finds no room: 429", answer and not problem_faults(
                answer, 429, "memory_full"), answer)
            check("with a time to come again", answer and int(answer.headers["retry-after"]) > 0)
            check("small ones do not suffer", ask(d.port, post(BOX)).status == 200)
        check("all of it is given back", until(lambda: says(d, b"waiting bodies: 0 of")))
        kill(workers(d.pid)[0], sig=signal.SIGCONT)


with Daemon("--workers", "1") as daemon:
    test_slow_alone(daemon)
    test_slow_in_company(daemon)
test_memory_full()
finish()
