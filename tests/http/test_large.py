#!/usr/bin/env python3
"""Bodies of several megabytes: every byte of them arrives, however they come."""
import hashlib
import random
import struct
import threading

from contract import *
from harness import *
from wire import *

BOX = stl(box((0, 0, 0), (40, 30, 20)))
BODY = BOX + random.Random(5).randbytes(9_000_001)  # bytes behind the facets are passed over
QUERY = "format=stl&include=digest"
DIGEST = hashlib.sha256(BODY).hexdigest()


def good(a):
    return (a is not None and a.status == 200 and at(a.json, "input.sha256") == DIGEST
            and at(a.json, "properties.volume") == 24000)


def test_whole(d):
    for extra in ([], ["-H", "Expect:"], ["-H", "Transfer-Encoding: chunked"], ["--http1.0"],
                  ["--limit-rate", "9M"]):
        check(f"nine megabytes by curl {extra}", good(d.post(BODY, *extra, query=QUERY)))


def test_pieces(d):
    for seed in range(4):
        chance = random.Random(seed)
        data, at_byte = post(BODY, QUERY), 0
        with Wire(d.port, 30) as w:
            while at_byte < len(data):
                n = chance.choice((1, 1000, 65536, 300_000, 2_000_000))
                w.send(data[at_byte:at_byte + n])
                at_byte += n
                if chance.random() < 0.1:
                    time.sleep(0.02)
            check(f"in pieces and with pauses ({seed})", good(w.one()))


def test_connection_goes_on(d):
    with Wire(d.port, 30) as w:
        for i in range(3):
            w.send(post(BODY, QUERY))
            check(f"body {i + 1} on a connection", good(w.one()))
    with Wire(d.port, 30) as w:
        w.send(post(BODY, QUERY) + post(BODY, QUERY) + request() + post(BOX))
        got = w.read(4)
        check("what stands behind a body is the next request", len(got) == 4 and good(got[0])
              and good(got[1]) and got[2].status == 200
              and at(got[3].json, "properties.volume") == 24000, [str(g) for g in got])


def test_side_by_side(d):
    answers = []

    def send():
        answers.append(d.post(BODY, "-H", "Expect:", query=QUERY))

    threads = [threading.Thread(target=send) for _ in range(5)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    check("five side by side", len(answers) == 5 and all(map(good, answers)))


def test_verdicts(d):
    facet = struct.pack("<12fH", *(12 * [float("nan")]), 0)
    bad = b"a mesh".ljust(80) + struct.pack("<I", 200_000) + facet * 200_000
    for checks in ("full", "closed"):
        check_problem(f"a verdict in the middle of a body, {checks}",
                      d.post(bad, "-H", "Expect:", query=f"checks={checks}"), 422, "non_finite")
    short = b"a mesh".ljust(80) + struct.pack("<I", 300_000) + bytes(50) * 200_000
    check_problem("facets that are missing at the end", d.post(short), 422, "truncated")


def test_who_leaves(d):
    for sent in (1, 600_000, 3_000_000, len(BODY) - 1):
        data = post(BODY, QUERY)
        for half in (False, True):
            with Wire(d.port) as w:
                w.send(data[:len(data) - len(BODY) + sent])
                if half:
                    w.finish()
                    check(f"half closed after {sent}", w.ends() and w.one() is None)
    check("and the next one is served", good(d.post(BODY, query=QUERY)))


with Daemon("--workers", "2") as daemon:
    test_whole(daemon)
    test_pieces(daemon)
    test_connection_goes_on(daemon)
    test_side_by_side(daemon)
    test_verdicts(daemon)
    test_who_leaves(daemon)
finish()
