#!/usr/bin/env python3
"""Every error of the contract that can be brought about, with what it says."""
import threading

from contract import *
from family import *
from harness import *
from wire import *

BOX = box((0, 0, 0), (40, 30, 20))
FILE = stl(BOX)
TEXT = stl_ascii(BOX)


def facet(values):
    return struct.pack("<12fH", 0, 0, 0, *values, 0)


def with_facet(index, values):
    return FILE[:84 + 50 * index] + facet(values) + FILE[134 + 50 * index:]


def test_file_faults(d):
    check_problem("no bytes", d.post(b""), 422, "empty")
    a = ask(d.port, request("POST", "/v1/mass-properties"))
    check("no body and no length", a and a.status == 422 and a.json["code"] == "empty", a)

    def prefixes():
        for n in (1, 5, 79, 80, 83, 84, 85, 133, 134, 683):
            a = ask(d.port, post(FILE[:n]))
            faults = problem_faults(a, 422, a.json["code"])
            yield n, faults or a.json["code"] not in ("truncated", "unreadable") and str(a)
            if n >= 84:
                yield n, problem_faults(a, 422, "truncated", byte=n)

    check_all("a binary file that is cut off anywhere", prefixes())
    more = FILE[:80] + struct.pack("<I", 2**32 - 1) + FILE[84:]
    check_problem("a count that the bytes do not bear out", d.post(more), 422, "truncated")
    a = d.post(TEXT[:TEXT.rindex(b"endloop")])
    check_problem("a text that is cut off in a facet", a, 422, "truncated", line=True)
    check_problem("a header and no facet", d.post(stl([])), 422, "no_faces")
    check_problem("a text without a facet", d.post(b"solid x\nendsolid x\n"), 422, "no_faces")
    for name, bad in (("NaN", math.nan), ("infinity", math.inf)):
        values = [0, 0, 0, 1, 0, 0, 0, 1, 0]
        values[4] = bad
        a = d.post(with_facet(3, values))
        at_byte = 84 + 3 * 50 + 12
        check_problem(f"{name} in a vertex", a, 422, "non_finite", byte=True)
        byte = (a.json or {}).get("byte", 0)
        check(f"{name}: its byte lies in the facet", at_byte <= byte < at_byte + 36, byte)
    lines = TEXT.split(b"\n")
    lines[3] = b"vertex 1 nan 2"
    a = d.post(b"\n".join(lines))
    check_problem("NaN in a text", a, 422, "non_finite", line=4, byte=True)
    lines[3] = b"vertex 1 1e999 2"
    check_problem("1e999 in a text", d.post(b"\n".join(lines)), 422, "non_finite", line=4)
    for bad in (b"vertex 1 2", b"vertex 1 2 x", b"vertex 1 2 3 4", b"vertez 1 2 3", b"vertex 1,2,3"):
        lines[3] = bad
        a = d.post(b"\n".join(lines))
        check_problem(f"{bad.decode()!r}: unreadable", a, 422, "unreadable", line=True)
    for name, data in (("words", b"no mesh at all\n" * 20), ("zeros", bytes(1000)),
                       ("a PNG", b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 4),
                       ("a pointer of Git LFS", b"version https://git-lfs.github.com/spec/v1\n"
                        b"oid sha256:" + b"4d7a2146" * 8 +
                        b"\nsize 12345\n")):
        a = d.post(data)
        check(f"{name}: refused as the file's fault", a.status == 422
              and not problem_faults(a, 422, a.json["code"]), a)
    for word in ("call part.obj", "csh rm -r x"):
        data = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n%s\nf 1 2 3\n" % word.encode()
        check_problem(f"an OBJ that says {word.split()[0]}", d.post(data), 422,
                      "unsupported_feature", line=4)
    a = d.post(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", query="format=stl")
    check_problem("a file that is not what format says", a, 400, "type_mismatch", option="format")


def test_not_a_solid(d):
    hole = box((10, 10, 5), (10, 10, 10))
    leaf = ((0, 0, 0), (1, 0, 0), (0, 1, 0))
    for name, mesh in (("open", BOX[2:]), ("inside out", flip(BOX)), ("flat", [leaf, leaf[::-1]]),
                       ("a cavity wound outward", BOX + hole),
                       ("winding", [BOX[0][::-1]] + BOX[1:])):
        a = d.post(stl(mesh), query="strict=true")
        check_problem(f"strict: {name}", a, 422, "not_a_solid")


def test_types(d):
    for kind in ("image/png", "application/json", "multipart/mixed; boundary=x",
                 "model/step", "model/stlx", "stl"):
        a = d.post(FILE, content_type=kind)
        check_problem(f"{kind}: refused", a, 415, "unsupported_media_type")
        check(f"{kind}: Accept-Post says what is taken",
              "model/stl" in a.headers.get("accept-post", ""), a)
    for coding in ("br", "deflate", "gzip, zstd", "identity, br", "x"):
        a = d.post(FILE, "-H", "Content-Encoding: " + coding)
        check_problem(f"{coding}: refused", a, 415, "unsupported_encoding")
        check(f"{coding}: Accept-Encoding says what is taken",
              a.headers.get("accept-encoding") == "gzip, zstd, identity", a)
    a = d.post(FILE, "-H", "Content-Encoding: identity")
    check("identity is taken", a.status == 200, a)


def test_sizes():
    with Daemon("--workers", "1", "--max-body", "10kB", "--max-triangles", "50") as d:
        big = stl(BOX * 20)
        a = d.post(big, "-H", "Expect:")
        check_problem("a length over the limit", a, 413, "body_too_large", limit=10000,
                      actual=len(big))
        a = d.post(big, "-H", "Transfer-Encoding: chunked", "-H", "Expect:")
        check_problem("chunks over the limit", a, 413, "body_too_large", limit=10000, actual=True)
        a = d.post(big, "-H", "Expect: 100-continue")
        check_problem("a length over the limit, asked before", a, 413, "body_too_large",
                      limit=10000)
        check("is answered without a 100", a.interim == [], a)
        with Wire(d.port) as w:
            w.send(post(b"", headers=["Expect: 100-continue"], length=10**15))
            got = w.read()
            check("and before any byte of the body", got and got[0].status == 413, *got)
        just = b"solid\n".ljust(10000 - len(TEXT)) + TEXT
        check("a body of just the limit is taken", d.post(just).status == 200)
        check_problem("one byte more is not", d.post(just + b"\n"), 413, "body_too_large",
                      limit=10000, actual=10001)
        a = d.post(stl(BOX * 5))
        check_problem("more triangles than the limit", a, 413, "too_many_triangles", limit=50,
                      actual=True)
        check("its figure", a.json["actual"] > 50, a)
        check("just so many are taken", d.post(stl(BOX * 4 + BOX[:2])).status == 200)
        a = d.post(stl_ascii(BOX * 5)[:9900])
        check_problem("more triangles in a text", a, 413, "too_many_triangles", limit=50)
        lie = FILE[:80] + struct.pack("<I", 10**9) + FILE[84:]
        check_problem("a count that is only claimed is no limit passed", d.post(lie), 422,
                      "truncated")
    with Daemon("--workers", "1", "--max-decoded", "600") as d:
        check_problem("a file over the decoded limit", d.post(FILE), 413, "decoded_too_large",
                      limit=600, actual=True)


def test_queue_full():
    """Workers that are stopped never finish: what comes then must wait, then be turned away."""
    with Daemon("--workers", "1", "--queue", "1") as d:
        asleep = workers(d.pid)
        kill(*asleep, sig=signal.SIGSTOP)
        answers, threads = [], []

        def send(data):
            answers.append(ask(d.port, post(data, "unit=mm"), 60))

        large = stl(BOX * 600)  # 360 kB: not for the small lane
        for i in range(3):  # two at work, one waits
            threads.append(threading.Thread(target=send, args=(FILE,)))
            threads[-1].start()
            until(lambda: f"in flight: {i + 2}" in d.get("/readyz?verbose").body.decode())
        a = d.post(FILE, timeout=20)
        check_problem("one small more than may wait", a, 429, "queue_full")
        check("Retry-After is a sane number", 1 <= int(a.headers.get("retry-after", 0)) <= 120, a)
        check("a full queue is no reason to be unready", d.get("/readyz").status == 200)
        a = d.post(FILE, "-H", "Expect: 100-continue", timeout=20)
        check("a full queue is told before the body comes", a.status == 429 and a.interim == [], a)
        threads.append(threading.Thread(target=send, args=(large,)))
        threads[-1].start()
        until(lambda: b"1 small, 1 large" in d.get("/readyz?verbose").body)
        check_problem("one large more than may wait", d.post(large, timeout=20), 429, "queue_full")
        a = d.post(large, "-H", "Transfer-Encoding: chunked", timeout=20)
        check_problem("one of unknown length", a, 429, "queue_full")
        check("probes never wait", d.get("/livez", timeout=5).status == 200)
        kill(*asleep, sig=signal.SIGCONT)
        for t in threads:
            t.join(60)
        check("those that waited are answered", len(answers) == 4
              and all(a and a.status == 200 for a in answers), *answers[:1])


def test_too_expensive():
    leaf = facet((0, 0, 0, 1, 0, 0, 0, 1, 0))
    n = 1200000
    heavy = bytes(80) + struct.pack("<I", n) + leaf * n
    with Daemon("--workers", "1", "--deadline", "10ms") as d:
        a = d.post(heavy)
        check_problem("work past the deadline", a, 422, "too_expensive")
        check("the next is served", until(lambda: d.post(FILE).status == 200))


def test_draining():
    with Daemon("--workers", "1", "--drain-delay", "400ms") as d, Wire(d.port) as w:
        before = workers(d.pid)
        kill(*before, sig=signal.SIGSTOP)
        w.send(post(FILE, "unit=mm"))
        until(lambda: b"in flight: 2" in d.get("/readyz?verbose").body)
        d.process.send_signal(signal.SIGTERM)
        with Wire(d.port) as probe:
            def unready():
                probe.send(request(path="/readyz"))
                return not (got := probe.one()) or got.status == 503
            check("readyz turns 503 at once", until(unready, 5))
        a = d.get("/readyz")
        check("while new connections are still served", a.status == 503 and a.body == b"draining\n"
              and a.headers.get("retry-after") == "1", a)
        late = Wire(d.port)  # its head comes when no new work is taken any more
        late.send(b"POST /v1/mass-properties HTTP/1.1\r\nHost: x\r\n")
        time.sleep(0.8)
        late.send(b"Content-Length: %d\r\n\r\n" % len(FILE) + FILE)
        a = late.one()
        check("work that comes later is refused", a and a.status == 503
              and a.json["code"] == "draining" and a.headers.get("retry-after")
              and a.headers.get("connection") == "close", a)
        late.socket.close()
        kill(*before, sig=signal.SIGCONT)
        a = w.one()
        check("work in flight is finished", a and a.status == 200, a)
        check("and the daemon ends", d.process.wait(20) == 0)


with Daemon("--workers", "1") as daemon:
    test_file_faults(daemon)
    test_not_a_solid(daemon)
    test_types(daemon)
test_sizes()
test_queue_full()
test_too_expensive()
test_draining()
finish()
