#!/usr/bin/env python3
"""Densities by name, names of bodies, and checks by the file's own vertex numbers."""
from urllib.parse import quote

import draco
from contract import *
from harness import *

OBJ = "model/obj"
SPHERE, TORUS = sphere((0, 0, 0), 3), torus((20, 1, 2), 5, 1)
BOX = box((-20, 0, 0), (2, 3, 4))


def obj(parts, shared=True, first=0):
    """OBJ text; ${parts}: statements (text), and meshes, whose vertices are numbered by place
    (${shared}: over all meshes) or, where not ${shared}, one for each corner."""
    number, lines = {}, []
    for p in parts:
        if isinstance(p, str):
            lines.append(p)
            continue
        for t in p:
            corners = []
            for at in t:
                key = at if shared else (len(lines), len(corners))
                if key not in number:
                    number[key] = first + len(number) + 1
                    lines.append("v " + " ".join(repr(float(x)) for x in at))
                corners.append(str(number[key]))
            lines.append("f " + " ".join(corners))
    return ("\n".join(lines) + "\n").encode()


def densities(**named):
    return "&".join(f"density[{quote(k)}]={v}" for k, v in named.items())


def about_origin(report):
    return report["properties"]["inertia"]["about_origin"]


def test_sums(d):
    """The whole is the sum of its parts, each sent alone."""
    parts = {"steel": (SPHERE, 7850), "pom natural": (TORUS, 1410), "Messing": (BOX, 8500)}
    query = densities(**{k: rho for k, (_, rho) in parts.items()})
    alone = [d.post(obj([mesh]), query=f"density={rho}", content_type=OBJ).json
             for mesh, rho in parts.values()]
    mass = sum(r["properties"]["mass"] for r in alone)
    centroid = [sum(r["properties"]["mass"] * r["properties"]["centroid"][k] for r in alone) / mass
                for k in range(3)]
    inertia = [[sum(about_origin(r)[i][k] for r in alone) for k in range(3)] for i in range(3)]
    volume = sum(r["properties"]["volume"] for r in alone)
    solids = b"".join(stl_ascii(mesh, name) for name, (mesh, _) in parts.items())
    files = {
        "usemtl": obj([x for k, (m, _) in parts.items() for x in (f"usemtl {k}", m)]),
        "o": obj([x for k, (m, _) in parts.items() for x in (f"o {k}", m)]),
        "g": obj([x for k, (m, _) in parts.items() for x in (f"g {k}", m)]),
        "o with groups": obj([x for k, (m, _) in parts.items()
                              for x in (f"o {k}", "g front", m[:7], "g back", m[7:])]),
        "usemtl over o and g": obj([x for k, (m, _) in parts.items()
                                    for x in (f"usemtl {k}", "o some", m[:5], "g other", m[5:])]),
        "solid": solids,
    }
    for how, file in files.items():
        a = d.post(file, query=query, content_type=OBJ if how != "solid" else "model/stl")
        p = at(a.json, "properties") or {}
        check(f"{how}: the sum of the parts", a.status == 200 and near(p["mass"], mass)
              and near(p["centroid"], centroid, 1e-11) and near(p["volume"], volume)
              and near(p["density"], mass / volume * 1e9)
              and all(abs(about_origin(a.json)[i][k] - inertia[i][k]) <= 1e-12 * inertia[1][1]
                      for i in range(3) for k in range(3)), a)
        check(f"{how}: the bodies", [b["mass"] for b in a.json["bodies"]]
              == [r["properties"]["mass"] for r in alone], a)
    a = d.post(files["o"], query=query + "&density=1", content_type=OBJ)
    check("a default that nothing takes changes nothing", near(at(a.json, "properties.mass"), mass),
          a)
    a = d.post(form(parts, files["usemtl"]), content_type="multipart/form-data; boundary=XX")
    check("as fields of a form", near(at(a.json, "properties.mass"), mass), a)


def form(parts, file):
    text = b"".join(f'--XX\r\nContent-Disposition: form-data; name="density[{k}]"\r\n\r\n{rho}\r\n'
                    .encode() for k, (_, rho) in parts.items())
    return (text + b'--XX\r\nContent-Disposition: form-data; name="file"; filename="a.obj"\r\n\r\n'
            + file + b"\r\n--XX--\r\n")


def test_defaults(d):
    file = obj([BOX, "usemtl steel", SPHERE, "usemtl paint", TORUS])
    sizes = [abs(volume(m)) for m in (BOX, SPHERE, TORUS)]
    for query, rho in (("density=2000&" + densities(steel=8000), (2000, 8000, 2000)),
                       ("material=water&" + densities(paint=1), (998.2, 998.2, 1)),
                       (densities(steel=3, paint=2) + "&density=1", (1, 3, 2))):
        a = d.post(file, query=query, content_type=OBJ)
        check(f"{query}", near(at(a.json, "properties.mass"),
                               sum(v * r for v, r in zip(sizes, rho)) * 1e-9, 1e-9), a)
    a = d.post(file, query=densities(paint=2) + "&density=1&density_unit=g/cm3&unit=in&mass_unit=lb",
               content_type=OBJ)
    check("in other units", near(at(a.json, "properties.mass"), (sizes[0] + sizes[1] + 2 * sizes[2])
                                 * 16.387064 / 453.59237, 1e-9), a)
    a = d.post(obj(["usemtl a", BOX[:-1], "usemtl b", SPHERE]),
               query=densities(b=2) + "&density=1", content_type=OBJ)
    check("what is open has no mass", a.status == 200 and at(a.json, "properties.mass") is None
          and at(a.json, "bodies.1.mass") is not None and "open_mesh" in warnings(a.json), a)
    half = obj(["usemtl a", BOX[:6], "usemtl b", BOX[6:]])
    a = d.post(half, query=densities(a=1, b=1), content_type=OBJ)
    check_problem("half a box is no solid", a, 400, "bad_option", option="density[a]")
    a = d.post(obj(["o a", BOX, "o b", flip(SPHERE)]), query=densities(a=1, b=1), content_type=OBJ)
    check("inside out among others", a.status == 200 and "named_against" in warnings(a.json)
          and near(at(a.json, "properties.mass"), (sizes[0] + sizes[1]) * 1e-9, 1e-9), a)


def test_problems(d):
    file = obj(["usemtl steel", BOX, "usemtl paint", SPHERE, "usemtl " + "long" * 30, TORUS])
    for query, option, words in (
            ("density[stel]=1&density=1", "density[stel]", "The names are: steel, paint, longlong"),
            ("density[steel]=1", "density[paint]", "no density"),
            ("density[steel]=1&density[steel]=1", "density[steel]", "more than once"),
            ("density[steel]=1&mass=1", "density[steel]", "exclude"),
            ("density[steel]=0", "density[steel]", "greater than 0"),
            ("density[steel]=1&density[steel%20]=1&density=1", "density[steel ]", "No faces"),
            ("density[" + "x" * 256 + "]=1", True, "255 bytes"),
            ("density[a]=1&density[b]=1&density=1", "density[a]", "No faces")):
        a = d.post(file, query=query, content_type=OBJ)
        check_problem(f"{query[:40]}: refused", a, 400, "bad_option", option=option)
        check(f"{query[:40]}: says why", words in at(a.json, "detail"), a)
    a = d.post(stl(BOX), query="density[a]=1&density=1")
    check_problem("a file without names", a, 400, "bad_option", option="density[a]")
    a = d.post(obj([BOX, "usemtl a", SPHERE]), query="density[a]=1", content_type=OBJ)
    check_problem("faces without a name", a, 400, "bad_option", option="density")
    a = d.get("/v1/capabilities")
    check("capabilities have it", "density[NAME]" in a.json["options"], a)


def test_body_names(d):
    a = d.post(obj(["o one", "usemtl steel", BOX, "g two", "usemtl paint", SPHERE[:9],
                    "usemtl steel", SPHERE[9:], "g", TORUS]), content_type=OBJ)
    check("bodies have the names of objects and groups, not of materials",
          [b["name"] for b in a.json["bodies"]] == ["one", "two", "one"], a)


def test_by_index(d):
    def by(file, query="", kind=OBJ):
        a = d.post(file, query=query, content_type=kind)
        return at(a.json, "checks.by_index"), at(a.json, "checks"), a

    faces = [BOX[i:i + 2] for i in range(0, 12, 2)]
    seams = b"".join(obj([f], first=4 * i) for i, f in enumerate(faces))
    index, checks, a = by(seams)
    check("a box of six faces: watertight by place, not by index", checks["watertight"]
          and checks["solid"] and index == {
              "closed": False, "watertight": False, "boundary_edges": 24, "non_manifold_edges": 0,
              "misoriented_edges": 0}, a)
    index, checks, a = by(obj([BOX]))
    check("a box with shared vertices: nothing to add", checks["watertight"] and index is None, a)
    index, checks, a = by(stl(BOX), kind="model/stl")
    check("STL numbers no vertices", index is None, a)
    twin = box((-18, 3, 0), (2, 3, 4))  # shares an edge with BOX in space
    index, checks, a = by(obj([BOX]) + obj([twin], first=8))
    check("two boxes that share an edge in space: manifold by index", checks["closed"]
          and checks["non_manifold_edges"] == 1 and index == {
              "closed": True, "watertight": True, "boundary_edges": 0, "non_manifold_edges": 0,
              "misoriented_edges": 0}, a)
    index, checks, a = by(obj([BOX, twin]))
    check("the same with one numbering", checks["non_manifold_edges"] == 1 and index is None, a)
    # a step of 42/3: 288 vertices fall onto a few places; Draco's numbers still know them apart
    coarse = draco.encode(obj([torus((0, 0, 0), 20, 1)]), "-qp", "2")
    index, checks, a = by(coarse, kind="model/x-draco")
    check("a coarsely quantised torus: watertight by index alone", not checks["watertight"]
          and index is not None and index["watertight"] and index["closed"], a)
    fine = draco.encode(obj([torus((0, 0, 0), 20, 1)]), "-qp", "16")
    index, checks, a = by(fine, kind="model/x-draco")
    check("a finely quantised one: both ways", checks["watertight"] and index is None, a)
    index, checks, a = by(obj([BOX + SPHERE + TORUS], shared=False))
    check("every corner for itself", index["boundary_edges"] == 3 * len(BOX + SPHERE + TORUS), a)
    kind = "multipart/form-data; boundary=XX"
    other = box((50, 0, 0), (1, 1, 1))
    two = b"".join(b'--XX\r\nContent-Disposition: form-data; name="file"; filename="%d.obj"\r\n\r\n'
                   % i + obj([m]) + b"\r\n" for i, m in enumerate((BOX, other))) + b"--XX--\r\n"
    index, checks, a = by(two, kind=kind)
    check("each file has numbers of its own", checks["watertight"] and index is None
          and at(a.json, "mesh.bodies") == 2, a)


with Daemon("--workers", "1") as daemon:
    test_sums(daemon)
    test_defaults(daemon)
    test_problems(daemon)
    test_body_names(daemon)
    test_by_index(daemon)
finish()
