#!/usr/bin/env python3
"""checks=closed: what it answers, what it refuses, and how little it takes for files of any size.

# tests/run: alone
"""
import gzip
import threading
import time

from contract import *
from family import *
from harness import *
from wire import *

BOX = box((0, 0, 0), (40, 30, 20))
OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
QUERY = "checks=closed&density=2700&unit=mm"
MIB = 1 << 20


def codes(a):
    return {w["code"] for w in a.json["warnings"]}


def test_report(d):
    a = d.post(stl(BOX), query=QUERY)
    full = d.post(stl(BOX), query="precision=certified&density=2700&unit=mm")
    check("a box", a.status == 200 and a.json["precision"] == "certified", a)
    checks, mesh = a.json["checks"], a.json["mesh"]
    check("its verdict", checks["closed"] is True and checks["orientation"] == "outward"
          and checks["solid"] is None and not a.json["warnings"], a)
    check("what needs a table is null",
          all(checks[k] is None for k in
              ("watertight", "winding_consistent", "boundary_edges", "boundary_loops",
               "non_manifold_edges", "non_manifold_vertices", "misoriented_edges",
               "duplicate_triangles", "duplicates_same", "duplicates_opposite", "double_walls",
               "single_walls", "overlapping_bodies", "by_index"))
          and all(mesh[k] is None for k in ("vertices", "edges", "bodies", "euler_characteristic"))
          and a.json["bodies"] is None and a.json["defects"] is None, a)
    check("what needs none is not", checks["degenerate_triangles"] == 0
          and checks["normals_disagreeing"] == 0 and mesh["triangles"] == 12
          and checks["closure_defect"] == [0, 0, 0], a)
    check("the numbers are the certified ones", a.json["properties"] == full.json["properties"]
          and a.json["error_bounds"] == full.json["error_bounds"]
          and mesh["bounding_box"] == full.json["mesh"]["bounding_box"],
          f"{a.body}\n{full.body}")
    check("listing none is no contradiction",
          d.post(stl(BOX), query="checks=closed&bodies=5&defects=5").json["bodies"] is None)


def test_verdicts(d):
    a = d.post(stl(BOX[:-1]), query=QUERY)
    check("an open box", a.status == 200 and a.json["checks"]["closed"] is False
          and a.json["checks"]["solid"] is False and a.json["checks"]["orientation"] == "none"
          and a.json["properties"]["volume"] is None and a.json["properties"]["mass"] is None
          and a.json["properties"]["surface_area"] < 5200 and codes(a) == {"not_closed"}
          and any(a.json["checks"]["closure_defect"]), a)
    a = d.post(stl(BOX[:-1]), query=QUERY + "&strict=true")
    check_problem("under strict", a, 422, "not_a_solid")
    a = d.post(stl(flip(BOX)), query=QUERY)
    check("inside out", a.json["checks"]["orientation"] == "inward"
          and a.json["properties"]["signed_volume"] == -24000 and codes(a) == {"inside_out"}, a)
    check_problem("that under strict", d.post(stl(flip(BOX)), query=QUERY + "&strict=true"), 422,
                  "not_a_solid")
    check("turned back", d.post(stl(flip(BOX)), query=QUERY + "&flip=true")
          .json["properties"]["signed_volume"] == 24000)
    one = [(b, a, c) if i == 5 else (a, b, c) for i, (a, b, c) in enumerate(BOX)]
    check("one triangle the wrong way round",
          d.post(stl(one), query=QUERY).json["checks"]["closed"] is False)
    thin = BOX + [((1, 1, 1), (1, 1, 1), (2, 2, 2)), ((0, 0, 0), (1, 1, 1), (2, 2, 2)),
                  ((0, 0, 0), (2, 2, 2), (1, 1, 1))]
    a = d.post(stl(thin), query=QUERY)
    check("degenerate triangles are counted", a.json["checks"]["closed"] is True
          and a.json["checks"]["degenerate_triangles"] == 3
          and codes(a) == {"degenerate_triangles"}, a)
    a, b = (d.post(f(sphere((7, 8, 9), 5)), query=QUERY) for f in (stl, stl_ascii))
    check("binary and text", a.json["checks"]["closed"] is b.json["checks"]["closed"] is True
          and b.json["input"]["format"] == "stl-ascii", f"{a}\n{b}")
    a = d.post(gzip.compress(stl(BOX)), "-H", "Content-Encoding: gzip", query=QUERY)
    check("compressed", a.status == 200 and a.json["properties"]["volume"] == 24000, a)


def form(*parts):
    out = b""
    for name, filename, data in parts:
        out += b'--XX\r\nContent-Disposition: form-data; name="' + name.encode() + b'"'
        out += (b'; filename="' + filename.encode() + b'"' if filename else b"") + b"\r\n\r\n"
        out += data + b"\r\n"
    return out + b"--XX--\r\n"


def post_form(d, *parts, query=""):
    return d.post(form(*parts), query=query, content_type="multipart/form-data; boundary=XX")


def test_forms(d):
    file, option = ("file", "a.stl", stl(torus((1, 2, 3), 9, 2))), ("checks", None, b"closed")
    a = post_form(d, option, file)
    check("an option before the file", a.status == 200 and a.json["bodies"] is None, a)
    same = []
    for b in (post_form(d, file, option), post_form(d, file, query="checks=closed")):
        same.append({k: v for k, v in b.json.items() if k != "timing_ms"})
    a.json.pop("timing_ms")
    check("behind it and in the query: the same report", same == [a.json] * 2, same)
    a = post_form(d, option, file, ("file", "b.stl", stl_ascii(BOX)))
    check("two files are one solid", a.status == 200 and a.json["checks"]["closed"] is True
          and a.json["input"]["format"] == "mixed", a)
    for name, parts in (("before", (option, ("file", "a.obj", OBJ))),
                        ("behind", (("file", "a.obj", OBJ), option)),
                        ("with an STL", (option, file, ("file", "a.obj", OBJ)))):
        check_problem(f"an OBJ, the option {name}", post_form(d, *parts), 400, "bad_option",
                      option="checks")


def test_refusals(d):
    check_problem("an OBJ", d.post(OBJ, query=QUERY), 400, "bad_option", option="checks")
    check_problem("a forced one", d.post(OBJ, query=QUERY + "&format=obj"), 400, "bad_option",
                  option="checks")
    for query, option in (("precision=exact", "precision"), ("density[a]=1", "density[a]"),
                          ("weld=0.1", "weld"), ("include=digest,facets", "include"),
                          ("include=self_intersections", "include"), ("orient=fix", "orient"),
                          ("transform=2,0,0,0,0,2,0,0,0,0,2,0", "transform")):
        check_problem(f"with {query}", d.post(stl(BOX), query="checks=closed&" + query), 400,
                      "bad_option", option=option)
    check_problem("no mesh", d.post(b"\0" * 300, query=QUERY), 422, "unreadable")
    whole = stl(BOX)
    check_problem("cut off", d.post(whole[:-7], query=QUERY), 422, "truncated", byte=677)
    bad = whole[:84 + 12 + 8] + b"\0\0\xc0\x7f" + whole[84 + 12 + 12:]
    a, b = (d.post(bad, query=q) for q in (QUERY, "unit=mm"))
    check("not finite: as with all checks", a.status == 422 and
          all(a.json[k] == b.json[k] for k in ("code", "detail", "byte")), f"{a}\n{b}")


def test_limits():
    with Daemon("--workers", "1", "--max-triangles", "10", "--max-decoded", "1kB") as d:
        check("the limit of triangles is for tables", d.post(stl(BOX), query=QUERY).status == 200)
        check_problem("which others need", d.post(stl(BOX)), 413, "too_many_triangles")
        check_problem("the limit of bytes is for all", d.post(gzip.compress(stl(BOX * 2)), "-H",
                      "Content-Encoding: gzip", query=QUERY), 413, "decoded_too_large")


class Upload(threading.Thread):
    """A file of ${copies} boxes, ${step} of them at a time, at most ${rate} bytes a second."""

    def __init__(self, port, copies, query, rate=0, step=200):
        super().__init__()
        self.facets, self.copies, self.rate, self.step = stl(BOX)[84:], copies, rate, step
        head = stl([])[:80] + struct.pack("<I", 12 * copies)
        self.length = len(head) + copies * len(self.facets)
        self.socket = socket.create_connection(("127.0.0.1", port), 60)
        self.socket.sendall(f"POST /v1/mass-properties?{query} HTTP/1.1\r\nHost: x\r\n"
                            f"Content-Length: {self.length}\r\n\r\n".encode() + head)
        self.sent, self.answer, self.go_on = 0, None, threading.Event()
        self.go_on.set()

    def run(self):
        began = time.monotonic()
        try:
            while self.sent < self.copies and not self.answer:
                n = min(self.step, self.copies - self.sent)
                self.socket.sendall(self.facets * n)
                self.sent += n
                self.go_on.wait()
                if self.rate:
                    ahead = self.sent * len(self.facets) / self.rate - (time.monotonic() - began)
                    time.sleep(max(0, ahead))
        except OSError:
            pass
        found = replies(receive_one(self.socket))
        self.answer = found[0] if found else None
        self.socket.close()


def receive_one(s):
    """Bytes until a whole answer is there, or the end."""
    got = b""
    try:
        while not replies(got) and (chunk := s.recv(65536)):
            got += chunk
    except OSError:
        pass
    return got


def memory(d):
    """Bytes of all its processes: their own, and what they share through files of memory."""
    total = 0
    for pid in [d.pid, *children(d.pid)]:
        try:
            with open(f"/proc/{pid}/status", encoding="ascii") as f:
                for line in f:
                    if line.startswith(("RssAnon:", "RssShmem:")):
                        total += int(line.split()[1]) * 1024
        except OSError:
            pass
    return total


def test_memory():
    with Daemon("--workers", "1", "--memory", "64MB") as d:
        check("warm", d.post(stl(BOX * 2000), query=QUERY).status == 200)
        time.sleep(0.3)
        idle, most = memory(d), 0
        up = Upload(d.port, 175000, "checks=closed")
        up.start()
        while up.is_alive():
            most = max(most, memory(d))
            time.sleep(0.02)
        up.join()
        check("105 MB through a daemon that has 64", up.answer is not None
              and up.answer.status == 200 and up.answer.json["checks"]["closed"] is True
              and up.answer.json["mesh"]["triangles"] == 12 * 175000
              and abs(up.answer.json["properties"]["volume"] - 24000 * 175000) < 1, up.answer)
        check("at most 64 MiB more than idle", 0 < most <= idle + 64 * MIB,
              f"{most / MIB:.1f} MiB, idle {idle / MIB:.1f} MiB")
        big = Upload(d.port, 175000, "unit=mm")
        big.start()
        big.join()
        check("a table of it does not fit", SANITIZED or big.answer is not None
              and big.answer.status in (422, 429), big.answer)


def held(d, query):
    """The answer to a slow upload of 22 MB to a spool of 16 while the one worker has other work."""
    holder = Upload(d.port, 12000, "checks=closed", step=6000)
    holder.go_on.clear()
    holder.start()  # it sends half, so fast that the worker takes it
    time.sleep(0.3)
    slow = Upload(d.port, 37000, query, rate=6e6)
    slow.start()
    for _ in range(200):  # until it stands still
        before = slow.sent
        time.sleep(0.2)
        if slow.sent == before or not slow.is_alive():
            break
    stood = slow.sent
    holder.go_on.set()
    holder.join()
    slow.join()
    return stood, holder.answer, slow.answer


def test_spool():
    with Daemon("--workers", "1", "--memory", "64MB") as d:
        stood, holder, slow = held(d, "checks=closed")
        check("the worker is free again", holder is not None and holder.status == 200, holder)
        check("an upload larger than the spool waits for a worker", stood < 37000, stood)
        check("and streams to it", slow is not None and slow.status == 200
              and slow.json["mesh"]["triangles"] == 12 * 37000
              and slow.json["checks"]["closed"] is True, slow)
        _, _, slow = held(d, "unit=mm")
        check("one that needs a table is refused", slow is not None and slow.status == 429
              and slow.json["code"] == "memory_full", slow)
        check("and the next one is served", d.post(stl(BOX), query=QUERY).status == 200)


with Daemon("--workers", "1") as d:
    test_report(d)
    test_verdicts(d)
    test_forms(d)
    test_refusals(d)
test_limits()
test_memory()
test_spool()
finish()
