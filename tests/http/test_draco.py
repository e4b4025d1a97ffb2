#!/usr/bin/env python3
"""Draco: real files by the real encoder, files that are wrong, and files that are meant to harm."""
import random
import threading

from contract import *
from draco import *
from family import *
from harness import *

BOX = stl(box((0, 0, 0), (40, 30, 20)))
# libdraco knows neither sanitizers nor their limits


def area(mesh):
    total = 0.0
    for a, b, c in mesh:
        u, v = ([q[i] - a[i] for i in range(3)] for q in (b, c))
        total += math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                            u[0] * v[1] - u[1] * v[0]) / 2
    return total


def near(x, y, error):
    return x is not None and abs(x - y) <= error


def post(d, data, **more):
    return d.post(data, content_type="model/x-draco", **more)


def test_encoder(d):
    """Level 0 is the sequential method; 7 and 10 code symbols by entropy."""
    meshes = (("box", box((1, 2, 3), (40, 30, 20)), 40), ("torus", torus((5, 0, 0), 8, 3), 22),
              ("sphere", sphere((0, 0, 100), 5), 10))
    for i, (name, mesh, size) in enumerate(meshes):
        for extras in (False, True):
            for level in (0, 5, 7, 10):
                bits = (0, 8, 11, 14, 16)[(level + i + extras) % 5]
                data = encode(obj(mesh, extras), "-cl", str(level), "-qp", str(bits))
                a = post(d, data, query="unit=mm")
                what = f"{name}, level {level}, {bits} bits{', normals and uv' * extras}"
                if not check(what, a.status == 200, a):
                    continue
                r, p = a.json, a.json["properties"]
                # each vertex is at most half a step off along each axis; or it is rounded to float
                shift = (size / (2 ** bits - 1) if bits else size * 2e-6) * 0.87
                check(f"{what}: format and count", r["input"]["format"] == "draco"
                      and r["mesh"]["triangles"] == len(mesh), a)
                check(f"{what}: within the quantisation", r["checks"]["watertight"]
                      and near(p["volume"], volume(mesh), 1.2 * shift * area(mesh))
                      and near(p["surface_area"], area(mesh), 3 * shift * size * len(mesh)), a)
                shown = decode(data)
                check(f"{what}: measured as the decoder shows it",
                      near(p["volume"], volume(shown), 1e-9 * volume(mesh))
                      and near(p["surface_area"], area(shown), 1e-9 * area(mesh)), a)


def test_extras(d):
    mesh = box((0, 0, 0), (40, 30, 20))
    data = encode(obj(mesh), "--metadata", "-qp", "0")
    a = post(d, data)
    check("metadata are passed over", a.status == 200 and a.json["properties"]["volume"] == 24000,
          a)
    a = post(d, data + b"12345678")
    check("bytes behind the mesh are a warning", a.status == 200
          and "trailing_bytes" in [w["code"] for w in a.json["warnings"]], a)
    a = d.post(data, query="format=drc", content_type=None)
    check("format=drc", a.status == 200, a)
    a = d.post(data, "-H", "Transfer-Encoding: chunked")
    check("found from the bytes, chunked", a.status == 200, a)
    a = post(d, encode(obj(mesh), "-point_cloud"))
    check_problem("a point cloud", a, 422, "point_cloud")
    check_problem("a mesh without any face", post(d, sequential((), ())), 422, "no_faces")
    for n in (8, 10, 20, len(data) // 2, len(data) - 1):
        a = d.post(data[:n], query="format=drc")
        check(f"a file cut after {n} bytes", a.status == 422
              and a.json["code"] in ("truncated", "unreadable"), a)
    a = d.post(BOX, query="format=drc")
    check_problem("a file that is none", a, 422, "unreadable")


def test_by_hand(d):
    points, faces = ((0, 0, 0), (2, 0, 0), (0, 3, 0), (0, 0, 4)), ((0, 2, 1), (0, 1, 3), (0, 3, 2),
                                                                   (1, 2, 3))
    a = post(d, sequential(points, faces))
    check("a tetrahedron", a.status == 200 and a.json["properties"]["volume"] == 4, a)
    a = post(d, sequential(points, faces[:3] + ((1, 2, 4),)))
    check_problem("an index beyond the points", a, 422, "bad_index")
    a = post(d, sequential(points[:3] + ((0, 0, math.nan),), faces))
    check_problem("a coordinate that is none", a, 422, "non_finite")
    a = post(d, sequential(points, faces, NORMAL))
    check_problem("a mesh without positions", a, 422, "unreadable")
    a = post(d, b"DRACO\2\3" + sequential(points, faces)[7:])
    check_problem("a version to come", a, 422, "unsupported_feature")


def test_replaced():
    """Who decoded Draco serves nobody else: both the lane of small bodies and the worker."""
    small = encode(obj(box((0, 0, 0), (1, 1, 1))))
    large = encode(obj(sphere((0, 0, 0), 5, 80)), "-cl", "0", "-qp", "0")
    with Daemon("--workers", "1") as d:
        for name, data in (("small", small), ("large", large)):
            for i in range(3):
                crew = workers(d.pid)
                a = post(d, data)
                check(f"{name} {i}", a.status == 200, a)
                check(f"{name} {i}: its worker is replaced",
                      until(lambda c=crew: len(workers(d.pid)) == 2
                            and len(set(workers(d.pid)) & set(c)) == 1), workers(d.pid))
        crew = workers(d.pid)
        good = [d.post(BOX).status for _ in range(4)] + [post(d, islands(10 ** 8)).status]
        check("who did not stays", good == [200] * 4 + [422] and workers(d.pid) == crew, good)
        crew = workers(d.pid)
        a = post(d, small[:-5])
        check("who failed at it goes as well", a.status == 422
              and until(lambda: len(set(workers(d.pid)) & set(crew)) == 1), a)
        before = d.log()
        # one after the other without a pause, then many at once: nobody gets a worker that leaves
        good = [post(d, small).status for _ in range(20)]
        crowd = [threading.Thread(target=lambda: good.append(post(d, small).status))
                 for _ in range(12)]
        for t in crowd:
            t.start()
        for t in crowd:
            t.join()
        check("all are answered", good == [200] * 32, good)
        log = d.log()[len(before):]
        check("and nothing about it is a warning", " warn " not in log and " error " not in log,
              log)


class Others:
    """Somebody else's requests, while a harmful one is at work: all have to be answered."""

    def __init__(self, d):
        self.d, self.statuses, self.stop = d, [], False
        self.thread = threading.Thread(target=self.run)

    def run(self):
        while not self.stop:
            self.statuses.append(self.d.post(BOX).status)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.stop = True
        self.thread.join()


def harm(d, name, data, codes, crowd=1):
    """${crowd} copies of a harmful file, each of which has to cost one 422 and nothing else."""
    answers = []
    with Others(d) as others:
        threads = [threading.Thread(target=lambda: answers.append(post(d, data)))
                   for _ in range(crowd)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
    for a in answers:
        check(f"{name}, {len(data)} bytes: one 422", a.status == 422 and a.json["code"] in codes
              and not problem_faults(a, 422, a.json["code"]), a)
    check(f"{name}: nobody else notices", others.statuses and set(others.statuses) == {200},
          others.statuses)


def test_harm():
    # libdraco 1.5.5 takes 46 s and 20 GB at the islands, 20 s at the spinner
    with Daemon("--workers", "2", "--memory", "1GiB", "--deadline", "2s") as d:
        harm(d, "islands", islands(400_000_000), ("truncated",))
        harm(d, "more islands", islands(1_400_000_000), ("truncated",))
        harm(d, "a count out of the air", standard("E", 600_000_000), ("truncated",))
        harm(d, "islands that may be", islands(500_000), ("unreadable", "too_expensive"))
        harm(d, "a spinner", spinner(40_000), ("too_expensive",))
        harm(d, "two spinners", spinner(40_000), ("too_expensive",), 2)
        if not SANITIZED:
            harm(d, "a fan of large values", fan(1_000_000), ("too_expensive",))
        check("nothing crashed", "signal 11" not in d.log() and "signal 6" not in d.log(), d.log())


def test_mutants(d):
    """What becomes of bits that flip is libdraco's affair; the service lives and says so."""
    dice = random.Random(1)
    mesh = torus((0, 0, 0), 8, 3, 12, 8)
    seeds = [encode(obj(mesh, True), "-cl", str(level), "-qp", "11") for level in (0, 5, 7, 10)]
    statuses = []
    for i in range(120):
        data = bytearray(seeds[i % 4])
        for _ in range(dice.randrange(1, 4)):
            data[dice.randrange(11, len(data))] = dice.randrange(256)
        statuses.append(post(d, bytes(data)).status)
    check("mutants are answered 200, 413 or 422", set(statuses) <= {200, 413, 422},
          sorted(set(statuses)))


with Daemon("--workers", "2") as daemon:
    test_encoder(daemon)
    test_extras(daemon)
    test_by_hand(daemon)
test_replaced()
test_harm()
if not SANITIZED:
    with Daemon("--workers", "2", "--memory", "1GiB", "--deadline", "2s") as daemon:
        test_mutants(daemon)
finish()
