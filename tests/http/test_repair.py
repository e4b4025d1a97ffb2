#!/usr/bin/env python3
"""What is repaired on request: vertices welded, winding made consistent."""
import random
from contract import *
from harness import *

BOX = box((0, 0, 0), (40, 30, 20))
HOLE = flip(box((10, 10, 5), (10, 10, 10)))


def report(d, mesh, query):
    a = d.post(stl(mesh), query="unit=mm&" + query)
    return a.json if a.status == 200 else {"problem": str(a)}


def torn(mesh, by):
    """Every second triangle a little off, as where facets were rounded one by one."""
    return [tuple(tuple(x + by * (i % 2) for x in p) for p in t) for i, t in enumerate(mesh)]


def message(r, code):
    return next((w["message"] for w in r["warnings"] if w["code"] == code), None)


def test_weld(d):
    mesh = torn(BOX + HOLE, 1 / 1024)
    r = report(d, mesh, "density=2700")
    check("a torn box is open", r["properties"]["volume"] is None and r["mesh"]["vertices"] == 32
          and r["repairs"]["welded_vertices"] == 0, r)
    r = report(d, mesh, "density=2700&weld=0.01")
    p = r["properties"]
    check("welded it is the box it was", p["volume"] == 23000 and p["mass"] == 0.0621
          and r["checks"]["watertight"] and r["mesh"]["vertices"] == 16
          and r["repairs"]["welded_vertices"] == 16 and r["bodies"][1]["cavity"]
          and r["mesh"]["bounding_box"]["max"] == [40, 30, 20], r)
    for seed in range(3):
        mixed = [t[k:] + t[:k] for t in mesh for k in (random.Random(seed).randrange(3),)]
        random.Random(seed).shuffle(mixed)
        again = report(d, mixed, "density=2700&weld=0.01&precision=exact")
        check(f"in any order of facets and corners ({seed})",
              again["properties"] == report(d, mesh, "density=2700&weld=0.01&precision=exact")
              ["properties"], again)
    r = report(d, mesh, "weld=1e-4")
    check("not where the distance is too small", r["repairs"]["welded_vertices"] == 0, r)
    r = report(d, BOX, "weld=1e300")
    check("all of it is one place where the distance is absurd",
          r["repairs"]["welded_vertices"] == 7 and r["checks"]["degenerate_triangles"] == 12
          and r["properties"]["surface_area"] == 0 and r["mesh"]["bodies"] == 0
          and "degenerate_triangles" in warnings(r), r)


def test_orient(d):
    good = BOX + HOLE
    for seed in range(4):
        r = random.Random(seed)
        turned = [r.random() < 0.4 for _ in good]
        mesh = [t[::-1] if f else t for t, f in zip(good, turned)]
        before = report(d, mesh, "density=2700")
        after = report(d, mesh, "density=2700&orient=fix")
        whole = report(d, good, "density=2700")
        check(f"turned at random ({seed}): no volume, but what it would be",
              before["properties"]["volume"] is None
              and near(before["properties"]["volume_if_oriented"], 23000)
              and "inconsistent_winding" in warnings(before), before)
        check(f"orient=fix winds it ({seed})",
              after["properties"] == whole["properties"] and after["checks"] == whole["checks"]
              and after["bodies"] == whole["bodies"]
              and after["repairs"]["flipped_triangles"] == sum(turned), after)
    r = report(d, flip(BOX) + flip(HOLE), "orient=fix")
    check("inside out it is all turned", r["properties"]["signed_volume"] == 23000
          and r["repairs"]["flipped_triangles"] == 24 and "inside_out" not in warnings(r), r)
    r = report(d, good, "orient=fix")
    check("what is good is left alone", r["repairs"]["flipped_triangles"] == 0
          and r["properties"]["volume_if_oriented"] is None, r)
    r = report(d, torn(flip(BOX)[:3] + BOX[3:] + HOLE, 1 / 1024), "weld=0.01&orient=fix")
    check("welding comes first", r["properties"]["signed_volume"] == 23000
          and r["repairs"] == {"flipped_triangles": 3, "welded_vertices": 16}, r)


def test_depth(d):
    """Bodies in bodies: outward, inward, outward, inward; each of them turned in turn."""
    boxes = [box((k, k, k), (20 - 2 * k,) * 3) for k in range(4)]
    want = [b if k % 2 == 0 else flip(b) for k, b in enumerate(boxes)]
    for turned in range(4):
        mesh = sum((flip(b) if k == turned else b for k, b in enumerate(want)), [])
        r = report(d, mesh, "")
        codes = warnings(r)
        check(f"depth {turned} turned: mixed, and no solid", r["checks"]["orientation"] == "mixed"
              and r["checks"]["solid"] is False and "mixed_bodies" in codes, r)
        check(f"depth {turned} turned: a cavity that counts twice is warned of",
              ("cavity_outward" in codes) == (turned != 2), codes)
        r = report(d, mesh, "orient=fix")
        check(f"depth {turned} turned: repaired", r["repairs"]["flipped_triangles"] == 12
              and r["checks"]["orientation"] == "outward"
              and r["properties"]["volume"] == 20 ** 3 - 18 ** 3 + 16 ** 3 - 14 ** 3
              and [b["depth"] for b in r["bodies"]] == [0, 1, 2, 3]
              and [b["cavity"] for b in r["bodies"]] == [False, True, False, True], r)


def moebius(n):
    def at(i, side):
        a = 2 * math.pi * (i % n) / n
        side = -side if i == n else side
        r = 10 + side * math.cos(a / 2)
        return (r * math.cos(a), r * math.sin(a), side * math.sin(a / 2))

    quads = [(at(i, -1), at(i + 1, -1), at(i + 1, 1), at(i, 1)) for i in range(n)]
    return [t for a, b, c, e in quads for t in ((a, b, c), (a, c, e))]


def test_one_side(d):
    for query in ("", "orient=fix"):
        r = report(d, box((50, 0, 0), (1, 1, 1)) + moebius(15), query)
        text = message(r, "non_orientable")
        check(f"a Moebius strip is named ({query or 'as it is'})", text is not None
              and text.endswith("Bodies: 1.") and r["bodies"][1]["orientable"] is False
              and r["bodies"][0]["orientable"] is True and r["repairs"]["flipped_triangles"] == 0
              and r["bodies"][0]["genus"] == 0 and r["bodies"][1]["genus"] is None, r)


with Daemon("--workers", "1") as daemon:
    test_weld(daemon)
    test_orient(daemon)
    test_depth(daemon)
    test_one_side(daemon)
finish()
