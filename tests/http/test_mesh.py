#!/usr/bin/env python3
"""POST /v1/mesh: the mesh as analysed comes back as binary STL about the point of Mesh-Origin."""
import gzip

from contract import *
from harness import *

BOX = box((0, 0, 0), (40, 30, 20))


def ask_mesh(d, body, *args, query=""):
    return d.post(body, *args, query=query, path="/v1/mesh")


def read(a):
    """(origin, triangles with the origin added, normals) of an answer."""
    origin = [float(x) for x in a.headers["mesh-origin"].split(",")]
    count = struct.unpack_from("<I", a.body, 80)[0]
    assert len(a.body) == 84 + 50 * count, (len(a.body), count)
    mesh, normals = [], []
    for i in range(count):
        f = struct.unpack_from("<12f", a.body, 84 + 50 * i)
        normals.append(f[:3])
        mesh.append(tuple(tuple(f[3 + 3 * c + k] + origin[k] for k in range(3)) for c in range(3)))
    return origin, mesh, normals


def rounded(mesh):
    return [tuple(struct.unpack("<3f", struct.pack("<3f", *p)) for p in t) for t in mesh]


def test_as_it_came(d):
    a = ask_mesh(d, stl(BOX))
    check("a mesh comes back as STL", a.status == 200 and a.headers["content-type"] == "model/stl"
          and not common_faults(a), a)
    origin, mesh, normals = read(a)
    check("near the origin as it came, bit by bit", origin == [0, 0, 0] and mesh == BOX, origin)
    check("with unit normals", normals[0] == (0, 0, -1) and all(
        near(sum(x * x for x in n), 1) for n in normals), normals)
    check("not as a text file would begin", not a.body.startswith(b"solid"), a.body[:80])
    odd = rounded([[(0.1, 0.2, 0.3), (1.1, 0.25, 0.37), (0.33, 1.7, 0.001)], *torus((3, 4, 5), 9, 2)])
    odd = [tuple(t) for t in odd]
    for name, data in (("ASCII", stl_ascii(odd)), ("binary", stl(odd))):
        check(f"float32 in {name} STL stays what it is", read(ask_mesh(d, data))[1] == odd)
    again = ask_mesh(d, a.body)
    check("posted again: the same bytes", again.body == a.body, again)
    plain = d.post(stl(odd))
    back = d.post(ask_mesh(d, stl(odd)).body)
    check("and the same report", untimed({**plain.json, "input": 0}) ==
          untimed({**back.json, "input": 0}), back)


def test_polygons_and_order(d):
    obj = b"v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\nf 6 1 4\n"
    _, mesh, _ = read(ask_mesh(d, obj))
    check("polygons come as the triangles that were counted", len(mesh) == 5 and
          mesh[4] == ((0, 2, 0), (0, 0, 0), (1, 1, 0)), mesh)
    report = d.post(stl(BOX[:-1]), query="defects=9").json
    _, mesh, _ = read(ask_mesh(d, stl(BOX[:-1])))
    edge = report["defects"]["boundary_edges"][0]
    corners = mesh[edge["triangles"][0]]
    check("triangle numbers of the report hold", all(tuple(v) in corners for v in edge["vertices"]),
          (edge, corners))
    a = ask_mesh(d, stl(BOX), query="flip=true")
    check("flip", read(a)[1] == [(t[0], t[2], t[1]) for t in BOX], read(a)[1][:2])
    check("and its normals", read(a)[2][0] == (0, 0, 1), read(a)[2][:2])


def test_far_away(d):
    far = box((1e9, -3e9, 0), (4, 3, 2))
    a = ask_mesh(d, stl_ascii(far))
    origin, mesh, _ = read(a)
    check("far from 0 the origin moves to the middle, where float32 has digits to spare",
          abs(origin[0] - 1e9) < 100 and abs(origin[1] + 3e9) < 300 and origin[2] == 0, origin)
    check("and nothing is lost", mesh == far, mesh[:2])
    check("0, the negative and what it straddles stay", read(ask_mesh(d, stl(box(
        (-20, -15, -10), (40, 30, 20)))))[0] == [0, 0, 0])
    tiny = box((5, 5, 5), (1e-9, 1e-9, 1e-9))
    _, mesh, _ = read(ask_mesh(d, stl_ascii(tiny)))
    check("a speck far out keeps its shape", near([max(p[k] for t in mesh for p in t) -
                                                   min(p[k] for t in mesh for p in t)
                                                   for k in range(3)], [1e-9] * 3, 1e-6))


def test_maps(d):
    a = ask_mesh(d, stl(BOX), query="transform=0,-1,0,100,1,0,0,0,0,0,1,5")
    want = [tuple((100 - y, x, 5 + z) for x, y, z in t) for t in BOX]
    check("mapped", read(a)[1] == want, read(a)[1][:2])
    a = ask_mesh(d, stl(BOX), query="transform=-1,0,0,0,0,1,0,0,0,0,1,0")
    want = [tuple((-t[i][0], t[i][1], t[i][2]) for i in (0, 2, 1)) for t in BOX]
    check("mirrored: wound outward still", read(a)[1] == want, read(a)[1][:2])
    moved = [tuple(tuple(x + (1e-6 if (i + k) % 7 == 0 else 0) for k, x in enumerate(p))
                   for p in t) for i, t in enumerate(BOX)]
    a = ask_mesh(d, stl_ascii(moved), query="weld=0.001")
    places = {p for t in read(a)[1] for p in t}
    check("welded", len(places) == 8, places)


def test_forms_and_codings(d):
    with tempfile.NamedTemporaryFile(suffix=".stl") as f:
        f.write(stl(BOX))
        f.flush()
        a = d.curl("/v1/mesh", "-F", f"file=@{f.name}", "-F", "flip=true", "-F", f"file=@{f.name}")
    check("a form with two files and an option behind the first", a.status == 200 and
          len(read(a)[1]) == 24 and read(a)[2][0] == (0, 0, 1), a)
    a = ask_mesh(d, gzip.compress(stl(BOX)), "-H", "Content-Encoding: gzip")
    check("a compressed body", a.status == 200 and read(a)[1] == BOX, a)
    large = stl(BOX * 2000)
    a = ask_mesh(d, large, "-H", "Transfer-Encoding: chunked")
    check("a large one", a.status == 200 and len(a.body) == len(large), a)
    a = ask_mesh(d, stl(BOX), "-H", "Origin: https://cad.test")
    check("a browser may read where the origin is", "Mesh-Origin" in a.headers.get(
        "access-control-expose-headers", ""), a)


def test_refusals(d):
    def refused(name, a, status, code, **extra):
        check_problem(name, a, status, code, instance="/v1/mesh", **extra)

    refused("a broken file", ask_mesh(d, stl(BOX)[:-10]), 422, "truncated")
    refused("an unknown option", ask_mesh(d, stl(BOX), query="x=1"), 400, "unknown_option")
    refused("checks=closed has no mesh", ask_mesh(d, stl(BOX), query="checks=closed"), 400,
            "bad_option", option="checks")
    with tempfile.NamedTemporaryFile(suffix=".stl") as f:
        f.write(stl(BOX))
        f.flush()
        a = d.curl("/v1/mesh", "-F", "checks=closed", "-F", f"file=@{f.name}")
    refused("in a form neither", a, 400, "bad_option", option="checks")
    refused("strict: no solid, no mesh", ask_mesh(d, stl(BOX[1:]), query="strict=true"), 422,
            "not_a_solid")
    check("an open mesh else", ask_mesh(d, stl(BOX[1:])).status == 200)
    refused("too large for float32", ask_mesh(d, stl_ascii(box((0, 0, 0), (1e300, 1, 1)))), 422,
            "unsupported_feature")
    refused("too small for it", ask_mesh(d, stl_ascii(box((0, 0, 0), (1e-300, 1e-300, 1e-300)))), 422,
            "unsupported_feature")
    a = d.get("/v1/mesh")
    check("POST only", a.status == 405 and a.headers["allow"] == "POST, OPTIONS", a)
    for accept, status in (("model/stl", 200), ("application/octet-stream", 200), ("*/*", 200),
                           ("model/*;q=0.5", 200), ("application/json", 406), ("text/html", 406),
                           ("model/stl;q=0, */*", 406)):
        a = ask_mesh(d, stl(BOX), "-H", "Accept: " + accept)
        check(f"Accept: {accept}: {status}", a.status == status, a)
    a = d.post(stl(BOX), "-H", "Accept: model/stl")
    check("the report is no STL", a.status == 406, a)


with Daemon("--workers", "1", "--cors-origin", "https://cad.test") as daemon:
    test_as_it_came(daemon)
    test_polygons_and_order(daemon)
    test_far_away(daemon)
    test_maps(daemon)
    test_forms_and_codings(daemon)
    test_refusals(daemon)
finish()
