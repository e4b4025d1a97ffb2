#!/usr/bin/env python3
"""The option transform: in the query, in forms before and behind the file, refused by name."""
from contract import *
from harness import *

SOLID = sphere((1, 2, 3), 4) + torus((20, 1, 2), 5, 1) + box((-20, 0, 0), (2, 3, 4))
TURN = "3,-4,0,10,4,3,0,20,0,0,5,-30"
MIRROR = "-1,0,0,0,0,2,0,0,0,0,1,0"
SHEAR = "1,2,0,0,0,1,0,0,0,0.5,1,0"


def rows(text):
    m = [float(x) for x in text.split(",")]
    return [m[i:i + 4] for i in range(0, 12, 4)]


def mapped(mesh, text):
    """As a CAD program would have exported it; all numbers are exact in float32."""
    m = rows(text)
    det = sum(m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3]
                         - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]) for i in range(3))
    out = [[tuple(sum(r[k] * v[k] for k in range(3)) + r[3] for r in m) for v in t] for t in mesh]
    return flip(out) if det < 0 else out


def coarse(mesh):
    """On a grid of 1/64, so that float32 holds it after mapping too."""
    return [[tuple(round(x * 64) / 64 for x in v) for v in t] for t in mesh]


def numbers(report):
    """All but what depends on how boxes lie: whether bodies are known not to overlap."""
    p, b = report["properties"], report["bodies"]
    checks = {k: v for k, v in report["checks"].items() if k not in ("solid", "overlapping_bodies")}
    return [report["mesh"]["bounding_box"], p["volume"], p["signed_volume"], p["mass"],
            p["centroid"], p["inertia"], p["principal"]["moments"], checks,
            [(x["volume"], x["mass"], x["centroid"], x["bounding_box"], x["orientation"],
              x["depth"]) for x in b]]


def test_same_as_exported(d):
    mesh = coarse(SOLID)
    query = "density=2700&unit=mm&about=1,2,3&axis=1,2,3&axis_origin=1,0,0&precision=exact"

    def cases():
        for text in (TURN, MIRROR, SHEAR, "0,0,1,5,1,0,0,6,0,1,0,7"):
            want = d.post(stl(mapped(mesh, text)), query=query)
            got = d.post(stl(mesh), query=f"{query}&transform={text}")
            yield text, got.status != 200 and str(got)
            yield text, differences(numbers(want.json), numbers(got.json))
            for path in ("properties.surface_area", "properties.surface_centroid",
                         "bodies.1.surface_area"):
                yield f"{text} {path}", not near(at(got.json, path), at(want.json, path))
            yield text, got.json["input"]["transform"] != rows(text)

    check_all("a mapped mesh is the mesh that was exported so, to the bit", cases())
    a = d.post(stl(mesh), query="unit=mm")
    check("without the option there is none", a.json["input"]["transform"] is None, a)


def test_mirrored(d):
    for query, orientation, flipped in (("", "outward", 0), ("&flip=true", "inward", 12)):
        a = d.post(stl(box((0, 0, 0), (40, 30, 20))), query=f"unit=mm&transform={MIRROR}{query}")
        sign = 1 if flipped == 0 else -1
        check(f"mirrored{query}: {orientation}", a.status == 200
              and at(a.json, "checks.orientation") == orientation
              and at(a.json, "properties.signed_volume") == sign * 48000
              and at(a.json, "mesh.bounding_box.min.0") == -40
              and at(a.json, "repairs.flipped_triangles") == flipped, a)


def test_forms(d, path):
    with open(path, "rb") as f:
        data = f.read()
    want = untimed(d.post(data, query=f"unit=mm&transform={SHEAR}").json)
    url = "/v1/mass-properties"

    def cases():
        options = ("-F", f"transform={SHEAR}", "-F", "unit=mm")
        for name, args in (("before", (*options, "-F", f"file=@{path}")),
                           ("behind", ("-F", f"file=@{path}", *options)),
                           ("around", (*options[:2], "-F", f"file=@{path}", *options[2:]))):
            a = d.curl(url, *args)
            got = untimed(a.json or {})
            got.get("input", {})["filename"] = None
            yield name, a.status != 200 and str(a)
            yield name, differences(want, got)

    check_all("a form may say it before the file or behind it", cases())
    for text, field in (("1,2,3,0,2,4,6,0,0,0,1,0", "singular"), ("1,2", "too short")):
        a = d.curl(url, "-F", f"file=@{path}", "-F", f"transform={text}")
        check_problem(f"behind the file: {field}", a, 400, "bad_option", option="transform")
    a = d.curl(url, "-F", f"file=@{path}", "-F", "transform=1e307,0,0,0,0,1,0,0,0,0,1,0")
    check_problem("what takes the mesh beyond the doubles", a, 400, "bad_option",
                  option="transform")
    a = d.curl(url, "-F", f"one=@{path}", "-F", f"two=@{path}", "-F", f"transform={TURN}")
    b = d.post(data, query=f"transform={TURN}")
    check("several files are mapped as one solid", a.status == 200 and near(
        at(a.json, "properties.surface_area"), 2 * at(b.json, "properties.surface_area")), a)


def test_words(d):
    data = stl(box((0, 0, 0), (1, 2, 3)))
    one = d.post(data, query=f"transform={TURN}")
    four = d.post(data, query=f"transform={TURN},0,0,0,1")
    check("16 numbers are 12 with a last row", four.status == 200
          and untimed(one.json) == untimed(four.json), four)
    for text in (TURN + ",0,0,0,2", TURN + ",0,0,1,1", TURN + ",0", TURN[:-4], TURN + ",0,0,0,1,0",
                 "", ",".join("0" * 12), TURN.replace("10", "nan"), TURN.replace("10", "1e999"),
                 "0.1,0.2,0,0,0.2,0.4,0,0,0,0,1,0", TURN.replace(",", ";")):
        a = d.post(data, query="transform=" + text)
        check_problem(f"transform={text}", a, 400, "bad_option", option="transform")
    a = d.post(data, query="transform=1e200,0,0,0,0,1e200,0,0,0,0,1e200,0&precision=exact")
    check("a volume that no double holds is null, with a warning", a.status == 200
          and at(a.json, "properties.volume") is None and "out_of_range" in warnings(a.json)
          and at(a.json, "properties.centroid") == [0.5e200, 1e200, 1.5e200]
          and b"nan" not in a.body.lower() and b"inf" not in a.body.lower(), a)


with tempfile.TemporaryDirectory() as tmp, Daemon("--workers", "2") as daemon:
    part = os.path.join(tmp, "part.stl")
    with open(part, "wb") as f:
        f.write(stl(SOLID))
    test_same_as_exported(daemon)
    test_mirrored(daemon)
    test_forms(daemon, part)
    test_words(daemon)
finish()
