#!/usr/bin/env python3
"""More than there is room for: bodies, connections, bombs; and what one mesh leaves for the next."""
# tests/run: alone
import gzip
import threading

from contract import *
from family import *
from harness import *
from wire import *

MB = 10 ** 6
FILE = stl(box((0, 0, 0), (40, 30, 20)))


def solid(facets):
    """A binary STL of so many facets, as quickly as Python makes one: boxes on top of each other."""
    return FILE[:80] + struct.pack("<I", facets) + FILE[84:] * (facets // 12)


class Watch:
    """The most memory() in the meantime."""

    def __init__(self, d):
        self.pid, self.most, self.over = d.pid, 0, threading.Event()
        self.thread = threading.Thread(target=self.run)

    def run(self):
        while not self.over.wait(0.03):
            self.most = max(self.most, memory(self.pid))

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()


def test_ten_times_too_much():
    """64 MB may wait; 40 clients bring 17 MB each, slowly enough to be collected."""
    body, answers = solid(340 * 1000 // 12 * 12), []
    with Daemon("--workers", "1", "--memory", "256MB", "--deadline", "60s") as d:
        idle = memory(d.pid)

        def client():
            with Wire(d.port, 120) as w:
                w.send(post(b"", length=len(body)))
                for at in range(0, len(body), 1 << 18):
                    time.sleep(0.06)
                    if not w.send(body[at:at + (1 << 18)]):
                        break
                answers.append(w.one())

        with Watch(d) as watch:
            threads = [threading.Thread(target=client) for _ in range(40)]
            for t in threads:
                t.start()
            for t in threads:
                t.join()
        statuses = [a.status if a else None for a in answers]
        check("ten times as many bodies as there is room for: served or told to come again",
              set(statuses) <= {200, 429, None} and 200 in statuses and 429 in statuses, statuses)
        faults = [f for a in answers if a and a.status == 429
                  for f in problem_faults(a, 429, a.json["code"])]
        check("with Retry-After", not faults and all(
            1 <= int(a.headers["retry-after"]) <= 60 for a in answers if a and a.status == 429),
            faults)
        check("they are collected meanwhile", watch.most - idle > 48 * MB,
              f"{(watch.most - idle) // MB} MB")
        check("within the budget", SANITIZED or watch.most - idle < 256 * MB,
              f"{(watch.most - idle) // MB} MB")
        check("and the budget is given back", until(
            lambda: b"waiting bodies: 0 of" in d.get("/readyz?verbose").body, 10))
        print(f"# {statuses.count(200)} of 40 served, {(watch.most - idle) // MB} MB at most")


def zstd(data):
    return subprocess.run(["zstd", "-q", "-c"], input=data, capture_output=True, check=True).stdout


def test_bombs():
    zeros = bytes(1 << 24)
    text = b"solid x\n" + b" " * (1 << 24)
    with Daemon("--workers", "1", "--memory", "256MB", "--max-decoded", "200MB") as d:
        d.post(FILE)
        idle = memory(d.pid)
        with Watch(d) as watch:
            for coding, pack in (("gzip", gzip.compress), ("zstd", zstd)):
                for name, data in (("zeros", pack(zeros) * 32), ("blanks", pack(text) * 32),
                                   ("in itself", pack(pack(zeros) * 32))):
                    a = d.post(data, "-H", f"Content-Encoding: {coding}")
                    check(f"a {coding} bomb of {name}: refused",
                          a.status in (413, 422) and a.json["code"] in
                          ("decoded_too_large", "unreadable", "truncated", "non_finite"), a)
        check("bombs burst in a small place", watch.most - idle < 64 * MB,
              f"{(watch.most - idle) // MB} MB")
        a = d.post(gzip.compress(bytes(80) + struct.pack("<I", 0xffffffff) + bytes(1 << 24)), "-H",
                   "Content-Encoding: gzip")
        check("a count that promises what does not come: refused", a.status in (413, 422), a)
        check("the next file is served", d.post(FILE).status == 200)


def test_aborted_uploads(d):
    body = solid(120000)
    for _ in range(50):
        ask(d.port, post(FILE))
    before = memory(d.pid)
    for i in range(1000):
        with Wire(d.port) as w:
            w.send(post(b"", length=len(body)) + body[:(i * 4099) % 400000])
    check("1000 uploads broken off are forgotten",
          until(lambda: b"in flight: 1\n" in d.get("/readyz?verbose").body, 20))
    check("the crew is there", until(lambda: b"workers: 3 of 3" in d.get("/readyz?verbose").body))
    for _ in range(50):
        ask(d.port, post(FILE))
    grown = memory(d.pid) - before
    check("they leave no more than 16 MiB behind", SANITIZED or grown < 16 << 20, f"{grown >> 10} KiB")
    print(f"# {grown >> 10} KiB after 1000 uploads broken off")


def test_crowd(d):
    """500 who say nothing, 200 who drip: somebody who wants something hardly notices."""
    idle = [d.connect() for _ in range(500)]
    drips = [d.connect() for _ in range(200)]
    for i, s in enumerate(drips):
        s.sendall(post(b"", length=10 ** 6 if i % 2 else 10 ** 4)[:None if i % 4 else 60])
    over = threading.Event()

    def drip():
        while not over.wait(0.05):
            for s in drips:
                try:
                    s.send(b"x")
                except OSError:
                    pass

    thread = threading.Thread(target=drip)
    thread.start()
    worst, good = 0.0, 0
    for i in range(30):
        for data in (post(FILE), request(), request(path="/readyz")):
            began = time.monotonic()
            a = ask(d.port, data)
            good += a is not None and a.status == 200
            worst = max(worst, time.monotonic() - began)
    over.set()
    thread.join()
    check("in a crowd of 700 everybody who asks is answered", good == 90, good)
    print(f"# {1000 * worst:.0f} ms was the longest of 90 requests beside 700 clients")
    for s in idle + drips:
        s.close()
    check("the crowd is forgotten",
          until(lambda: b"in flight: 1\n" in d.get("/readyz?verbose").body, 20))


def test_honest_retry_after():
    """Who is told to come again later and does, is served once there is room."""
    with Daemon("--workers", "1", "--queue", "1") as d:
        crew = workers(d.pid)
        kill(*crew, sig=signal.SIGSTOP)
        wires = []
        refused = None
        for _ in range(12):
            w = Wire(d.port, 60)
            w.send(post(FILE))
            wires.append(w)
        check("the queue fills", until(lambda: b"queue: 1 small" in d.get("/readyz?verbose").body))
        refused = ask(d.port, post(FILE))
        check("a full queue: 429", refused and not problem_faults(refused, 429, "queue_full"),
              refused)
        check("with a time to come again", 1 <= int(refused.headers["retry-after"]) <= 30, refused)
        kill(*crew, sig=signal.SIGCONT)
        time.sleep(int(refused.headers["retry-after"]))
        a = ask(d.port, post(FILE))
        check("then there is room", a and a.status == 200, a)
        for w in wires:
            w.socket.close()


def test_unread_answers_end():
    # some 4 MB: more than the two ends' socket buffers take while nobody reads
    soup = b"".join(struct.pack("<12fH", 0, 0, 0, i, 0, 0, i, 1, 0, i, 0, 1, 0) for i in range(9000))
    with Daemon("--workers", "1", "--write-timeout", "500ms") as d:
        s = socket.socket()
        s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        s.settimeout(20)
        s.connect(("127.0.0.1", d.port))
        whole = len(d.post(FILE[:80] + struct.pack("<I", 9000) + soup, query="defects=100000").body)
        s.sendall(post(FILE[:80] + struct.pack("<I", 9000) + soup, "defects=100000"))
        check("a large answer begins", s.recv(12)[9:] == b"200")
        check("who does not take it within --write-timeout loses it",
              until(lambda: b"in flight: 1\n" in d.get("/readyz?verbose").body, 60))
        got = len(receive(s))
        check("its connection ends early", 0 < got < whole, f"{got} of {whole}")
        s.close()


def with_name(mesh, name):
    return stl_ascii(mesh, name=name)


def test_nothing_is_left_over():
    """One worker, meshes of every kind in turn: each report is as a fresh daemon gives it."""
    secret = "CUSTOMER-A-4711"
    obj = f"o {secret}\nusemtl {secret}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" \
          "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    meshes = {
        "named": (with_name(box((0, 0, 0), (1, 2, 3)), secret), ""),
        "obj": (obj.encode(), f"density[{secret}]=3"),
        "open": (stl(box((0, 0, 0), (1, 2, 3))[:-1], header=secret.encode()), ""),
        "broken": (with_name(box((0, 0, 0), (1, 2, 3)), secret)[:-400], ""),
        "not finite": (with_name(box((0, 0, 0), (1, 2, math.inf)), secret), ""),
        "large": (solid(120000), "defects=3"),
        "plain": (FILE, "about=1,2,3"),
        "exact": (stl(torus((1e6, 0, 0), 30, 10)), "precision=exact"),
        "inside out": (stl(flip(sphere((0, 0, 0), 3))), "axis=1,1,1"),
        "form": None,
    }

    def post_one(d, kind):
        if kind == "form":
            return d.curl("/v1/mass-properties", "-F", "density=2", "-F",
                          f"file=@{path};filename=b.stl")
        body, query = meshes[kind]
        return d.post(body, query=query)

    def essence(a):
        return {k: v for k, v in (untimed(a.json) or {}).items() if k not in ("request_id",)}

    with tempfile.NamedTemporaryFile(suffix=".stl") as f:
        path = f.name
        f.write(FILE)
        f.flush()
        fresh = {}
        for kind in meshes:
            with Daemon("--workers", "1") as d:
                fresh[kind] = essence(post_one(d, kind))
        with Daemon("--workers", "1") as d:
            crew = workers(d.pid)
            order = list(meshes)
            order = order + order[::-1] + order[::3] + order[1::3] + order[2::3]
            wrong = [k for k in order if essence(post_one(d, k)) != fresh[k]]
            check("whatever came before, a report is the same", not wrong, wrong)
            check("it was always the same workers", workers(d.pid) == crew, d.log())
            texts = [post_one(d, k).body for k in ("named", "plain", "open", "form", "large")]
            check("no name of one file stands in the report of another",
                  secret.encode() in texts[0] and not any(secret.encode() in t for t in texts[1:]))


test_ten_times_too_much()
test_bombs()
with Daemon("--workers", "2") as daemon:
    test_aborted_uploads(daemon)
with Daemon("--workers", "2") as daemon:
    test_crowd(daemon)
test_honest_retry_after()
test_unread_answers_end()
test_nothing_is_left_over()
finish()
