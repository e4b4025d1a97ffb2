#!/usr/bin/env python3
"""Many requests on one connection, many connections, slow ones, and small ones beside large."""
import threading

from contract import *
from family import *
from harness import *
from wire import *

BOX = box((0, 0, 0), (40, 30, 20))
FILE = stl(BOX)
BIG = stl(BOX * 20000)  # 12 MB
POST = b"POST /v1/mass-properties?unit=mm HTTP/1.1\r\nHost: x\r\nContent-Length: %d\r\n\r\n"


def part(i):
    """A box of volume 6 * i and its file: answers must not be mixed up."""
    return 6 * i, stl(box((0, 0, 0), (1, 2, 3 * i)))


def right(a, want):
    return a is not None and a.status == 200 and a.json["properties"]["volume"] == want


def test_one_connection(d):
    with Wire(d.port) as w:
        good = 0
        for i in range(1, 201):
            want, data = part(i)
            w.send(post(data, headers=[f"X-Request-Id: r{i}"]))
            a = w.one()
            good += right(a, want) and a.headers["x-request-id"] == f"r{i}"
    check("200 requests on one connection", good == 200, good)
    with Wire(d.port) as w:
        mixed = [post(FILE), request(), post(b"no mesh"), request("POST", "/livez"),
                 post(FILE, "nonsense=1"), request(path="/nothing"), post(b""),
                 request("HEAD", "/livez"), request("OPTIONS", "/v1/mass-properties")]
        want = [200, 200, 422, 405, 400, 404, 422, 200, 204]
        got = []
        for r in mixed:
            w.send(r)
            a = w.one(head=r.startswith(b"HEAD"))
            got.append(a.status if a else None)
        check("errors do not cost the connection", got == want, got)


def test_pipeline(d):
    with Wire(d.port) as w:
        files = [part(i) for i in range(1, 41)]
        w.send(b"".join(post(data) + request(path="/readyz") for _, data in files))
        got = w.read(80)
        volumes = [right(a, want) for a, (want, _) in zip(got[::2], files)]
        check("80 requests sent at once are answered in order", len(got) == 80 and all(volumes)
              and all(a.body == b"ready\n" for a in got[1::2]), len(got))
    with Wire(d.port) as w:
        pieces = [FILE[i:i + 100] for i in range(0, len(FILE), 100)]
        head = b"POST /v1/mass-properties HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
        w.send((head + chunked(pieces)) * 3 + request())
        got = w.read(4)
        check("chunked ones too", [a.status for a in got] == [200] * 4 and right(got[2], 24000),
              [str(a) for a in got])
    with Wire(d.port) as w:
        text = b"".join(post(part(i)[1]) for i in range(1, 6))
        for i in range(0, len(text), 37):
            w.send(text[i:i + 37])
        got = w.read(5)
        check("in pieces that end anywhere", all(right(a, 6 * i) for i, a in enumerate(got, 1))
              and len(got) == 5, len(got))


def test_parallel(d):
    faults = []

    def client(k):
        with Wire(d.port, 60) as w:
            for i in range(1, 13):
                want, data = part(k * 100 + i)
                if i % 4 == 0:  # not for the small lane
                    want = 501 * 100 * (k + 1)
                    data = stl(box((0, 0, 0), (10, 10, k + 1)) * 501)
                w.send(post(data))
                a = w.one()
                if not right(a, want):
                    faults.append(f"client {k}, request {i}: {a}")
                    return

    threads = [threading.Thread(target=client, args=(k,)) for k in range(16)]
    for t in threads:
        t.start()
    for t in threads:
        t.join(60)
    check("16 clients with 12 requests each: everybody gets his own answer", not faults,
          "\n".join(faults))
    check("then all is quiet", until(lambda: b"in flight: 1\n" in d.get("/readyz?verbose").body),
          d.get("/readyz?verbose"))


def test_small_lane(d):
    """Two uploads hold both workers; both halves are there, so that nothing depends on speed."""
    with Wire(d.port, 30) as a, Wire(d.port, 30) as b:
        half = len(BIG) // 2
        for w in (a, b):
            w.send(POST % len(BIG) + BIG[:half])
        until(lambda: b"in flight: 3\n" in d.get("/readyz?verbose").body)
        good = 0
        for i in range(1, 21):
            want, data = part(i)
            good += right(ask(d.port, post(data), 10), want)
        check("large uploads do not hold up small ones", good == 20, good)
        for w in (a, b):
            w.send(BIG[half:])
        ends = [w.one() for w in (a, b)]
        check("and are answered when they are complete", all(x and x.status == 200 for x in ends),
              *ends[:1])


def test_slow_upload(d):
    """Bodies that drip collect in the front: large ones find the workers free."""
    with Wire(d.port, 30) as a, Wire(d.port, 30) as b, Wire(d.port, 30) as c:
        slow = (a, b, c)
        for w in slow:
            w.send(POST % len(BIG) + BIG[:1000])
        time.sleep(0.3)  # from here on they are known to be slow
        for i in range(1000, 13000, 2000):
            for w in slow:
                w.send(BIG[i:i + 2000])
            time.sleep(0.02)
        other = ask(d.port, post(BIG), 20)
        check("drips hold no worker", other and other.status == 200, other)
        for w in slow:
            w.send(BIG[13000:])
        ends = [w.one() for w in slow]
        check("and are answered too", all(x and x.status == 200 for x in ends),
              [str(x)[:300] for x in ends])


def test_timeouts():
    with Daemon("--workers", "1", "--header-timeout", "300ms", "--body-timeout", "600ms") as d:
        with Wire(d.port, 8) as w:
            check("who says nothing is let go", w.ends() and not w.data, w.data)
        with Wire(d.port, 8) as w:
            w.send(b"GET /livez HTTP/1.1\r\nHost: x\r\nX-A")
            check("who does not finish his head, too", w.ends(), w.data)
        with Wire(d.port, 8) as w:
            ended = False
            w.socket.settimeout(0.05)
            w.send(b"GET /livez HTTP/1.1\r\n")
            for i in range(100):  # a line now and then does not help
                if not w.send(b"X-%d: 1\r\n" % i) or (w._more() is False and w.closed):
                    ended = True
                    break
            check("a head that drips is let go", ended)
        for name, start in (("a small", 300), ("a large", 2000000)):
            with Wire(d.port, 8) as w:
                w.send(POST % len(BIG) + BIG[:start])
                a = w.one()
                check(f"{name} body that stops is told so", a
                      and not problem_faults(a, 408, "too_slow"), a or w.data)
                check("and let go", w.ends())
        with Wire(d.port, 8) as w:
            w.send(request())
            w.one()
            time.sleep(0.8)
            w.send(request())
            a = w.one()
            check("a connection may rest between requests for longer", a and a.status == 200, a)
        check("nothing is left behind",
              until(lambda: b"in flight: 1\n" in d.get("/readyz?verbose").body))
        a = ask(d.port, post(BIG), 20)
        check("and the next file is served", a and a.status == 200, a)


def test_unread_answers(d):
    """More than the system buffers: an answer that waits for its reader must wait alone."""
    wedges = [t for i in range(10000) for t in wedge((3 * i, 0, 0), (1, 1, 1))]
    large = post(stl(wedges), "bodies=10000&unit=mm")
    asleep, slow = Wire(d.port, 20), Wire(d.port, 20)
    for w in (asleep, slow):
        w.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 65536)
        w.send(large)
    good = [right(ask(d.port, post(part(i)[1]), 10), 6 * i) for i in range(1, 6)]
    check("answers that nobody reads hold up nobody", all(good), good)
    time.sleep(0.3)
    a = slow.one()
    check("who reads late gets all of it", a and a.status == 200 and len(a.body) > 4 << 20
          and len(a.json["bodies"]) == 10000 and near(a.json["properties"]["volume"], 5000),
          len(slow.data))
    for w in (asleep, slow):
        w.socket.close()
    check("who leaves before is forgotten",
          until(lambda: b"in flight: 1\n" in d.get("/readyz?verbose").body))


with Daemon("--workers", "2", "--queue", "64") as daemon:
    test_one_connection(daemon)
    test_pipeline(daemon)
    test_parallel(daemon)
    test_small_lane(daemon)
    test_slow_upload(daemon)
    test_unread_answers(daemon)
test_timeouts()
finish()
