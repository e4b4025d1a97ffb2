#!/usr/bin/env python3
"""The report: the contract's example field by field, the null rules, bodies, defects, names."""
from contract import *
from harness import *

BOX = box((0, 0, 0), (40, 30, 20))
NO_DEFECTS = {k: [] for k in ("boundary_edges", "boundary_loops", "non_manifold_edges",
                              "non_manifold_vertices", "misoriented_edges",
                              "degenerate_triangles", "duplicate_triangles")}
BODY = {"triangles": 12, "volume": 24000, "surface_area": 5200, "mass": 0.0648,
        "centroid": [20, 15, 10],
        "inertia_about_centroid": [[7.02, 0, 0], [0, 10.8, 0], [0, 0, 13.5]],
        "bounding_box": {"min": [0, 0, 0], "max": [40, 30, 20]}, "watertight": True,
        "orientable": True, "genus": 0, "orientation": "outward", "depth": 0, "parent": None, "cavity": False, "name": None}
EXAMPLE = {
    "schema": "masspropd/1",
    "input": {"filename": None, "format": "stl-binary", "bytes": 684, "unit": "mm",
              "transform": None},
    "units": {"length": "mm", "area": "mm2", "volume": "mm3", "mass": "kg", "density": "kg/m3",
              "inertia": "kg.mm2"},
    "mesh": {"triangles": 12, "polygons": 0, "surfaces": 0, "vertices": 8, "edges": 18, "bodies": 1,
             "euler_characteristic": 2,
             "bounding_box": {"min": [0, 0, 0], "max": [40, 30, 20], "size": [40, 30, 20]}},
    "checks": {"closed": True, "watertight": True, "winding_consistent": True,
               "orientation": "outward", "solid": True, "boundary_edges": 0, "boundary_loops": 0,
               "non_manifold_edges": 0, "non_manifold_vertices": 0, "misoriented_edges": 0,
               "degenerate_triangles": 0, "duplicate_triangles": 0, "duplicates_same": 0,
               "duplicates_opposite": 0, "double_walls": 0, "single_walls": 0,
               "normals_disagreeing": 0,
               "overlapping_bodies": 0, "self_intersections": None, "closure_defect": [0, 0, 0],
               "closes_at_tolerance": None, "by_index": None},
    "properties": {
        "volume": 24000, "signed_volume": 24000, "surface_area": 5200,
        "surface_centroid": [20, 15, 10], "density": 2700, "mass": 0.0648, "centroid": [20, 15, 10],
        "inertia": {"convention": "tensor: [0][1] = -integral of density*x*y",
                    "about_origin": [[28.08, -19.44, -12.96], [-19.44, 43.2, -9.72],
                                     [-12.96, -9.72, 54]],
                    "about_centroid": [[7.02, 0, 0], [0, 10.8, 0], [0, 0, 13.5]],
                    "about_point": None, "point": None, "about_axis": None},
        "principal": {"moments": [7.02, 10.8, 13.5], "axes": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
                      "quaternion_wxyz": [1, 0, 0, 0], "symmetry": "none"},
        "volume_if_capped": None, "cap_area": None, "volume_if_oriented": None},
    "bodies": [BODY], "defects": {**NO_DEFECTS, "truncated": False},
    "repairs": {"flipped_triangles": 0, "welded_vertices": 0},
}


def report(d, mesh, query="density=2700&unit=mm", data=None):
    a = d.post(data if data is not None else stl(mesh), query=query)
    return a.json if a.status == 200 else {"problem": str(a)}


def test_example(d):
    a = d.post(stl(BOX), query="density=2700")
    faults = differences(EXAMPLE, a.json)
    check("the contract's box, field by field", a.status == 200 and not faults, "\n".join(faults))
    radii = at(a.json, "properties.principal.radii_of_gyration")
    check("its radii of gyration", near(radii, [10.4083, 12.9099, 14.4338], 4e-6), radii)
    check("the unit was assumed", warnings(a.json) == {"unit_assumed"}, a)
    check("times are given", set(a.json["timing_ms"]) == {"receive", "queue", "decode", "analyse"}
          and all(t >= 0 for t in a.json["timing_ms"].values()), a.json["timing_ms"])
    check("precision and error bounds have their places",
          a.json.get("precision", 0) in (None, "certified", "exact")
          and (a.json.get("error_bounds", 0) is None or "volume" in a.json["error_bounds"]), a)
    b = d.post(stl_ascii(BOX, ""), query="density=2700")
    want = {**EXAMPLE, "input": {"filename": None, "format": "stl-ascii", "unit": "mm",
                                 "transform": None,
                                 "bytes": len(stl_ascii(BOX, ""))}}
    faults = differences(want, b.json)
    check("the same as text", b.status == 200 and not faults, "\n".join(faults) or b)


def test_wedge(d):
    p = report(d, wedge((0, 0, 0), (40, 25, 8)))["properties"]
    check("a wedge: volume, mass, centroid", p["volume"] == 4000 and p["mass"] == 0.0108
          and near(p["centroid"], [40 / 3, 25 / 3, 4]), p)
    rho, v, a, b, c = 2.7e-6, 4000, 40, 25, 8
    i = p["inertia"]["about_centroid"]
    want = [[rho * v * (b * b / 18 + c * c / 12), rho * v * a * b / 36, 0],
            [rho * v * a * b / 36, rho * v * (a * a / 18 + c * c / 12), 0],
            [0, 0, rho * v * (a * a + b * b) / 18]]
    close = all(abs(i[r][k] - want[r][k]) < 1e-14 for r in range(3) for k in range(3))
    check("its inertia, signs included", close, f"{i}\n{want}")
    area = (a * b) + c * (a + b + (a * a + b * b) ** 0.5)
    check("its area", near(p["surface_area"], area), p)
    moments, axes = p["principal"]["moments"], p["principal"]["axes"]
    cross = [axes[0][1] * axes[1][2] - axes[0][2] * axes[1][1],
             axes[0][2] * axes[1][0] - axes[0][0] * axes[1][2],
             axes[0][0] * axes[1][1] - axes[0][1] * axes[1][0]]
    check("its principal axes: ascending, right-handed, largest component positive",
          moments == sorted(moments) and all(abs(x - y) < 1e-12 for x, y in zip(cross, axes[2]))
          and all(max(row, key=abs) > 0 for row in axes[:2]), p["principal"])
    trace = sum(want[k][k] for k in range(3))
    check("whose moments add up", near(sum(moments), trace), moments)


def test_null_rules(d):
    r = report(d, BOX, "unit=mm")
    u, p = r["units"], r["properties"]
    check("without a density: no mass, inertia for density 1", u["mass"] is None
          and u["density"] is None and u["inertia"] == "mm5" and p["mass"] is None
          and p["density"] is None and p["inertia"]["about_centroid"][0][0] == 2600000
          and p["centroid"] == [20, 15, 10] and r["bodies"][0]["mass"] is None, r)
    r = report(d, BOX[2:])
    p, c = r["properties"], r["checks"]
    gone = ("volume", "signed_volume", "mass", "centroid", "inertia", "principal")
    check("an open mesh has no volume, and says why", all(p[k] is None for k in gone)
          and "open_mesh" in warnings(r) and not (c["closed"] or c["watertight"] or c["solid"])
          and c["orientation"] == "none" and r["bodies"][0]["volume"] is None, r)
    check("but area, box and counts", p["surface_area"] == 4000
          and p["surface_centroid"] == [20, 15, 13] and c["closure_defect"] == [0, 0, 1200]
          and r["mesh"]["bounding_box"]["size"] == [40, 30, 20] and r["mesh"]["edges"] == 17
          and c["boundary_edges"] == 4 and c["boundary_loops"] == 1, r)
    leaf = ((0, 0, 0), (1, 0, 0), (0, 1, 0))
    r = report(d, [leaf, leaf[::-1]])
    p = r["properties"]
    check("a closed mesh without volume", p["volume"] == 0 and p["centroid"] is None
          and p["inertia"] is None and p["surface_area"] == 1 and "zero_volume" in warnings(r)
          and r["checks"]["closed"] and r["checks"]["solid"] is False, r)
    r = report(d, [leaf])
    check("one triangle", r["properties"]["volume"] is None and r["checks"]["boundary_edges"] == 3
          and near(r["properties"]["surface_area"], 0.5), r)


def test_inside_out(d):
    r = report(d, flip(BOX))
    p = r["properties"]
    check("inside out: answered as the solid it means", p["volume"] == 24000
          and p["signed_volume"] == -24000 and p["mass"] == 0.0648
          and p["inertia"]["about_centroid"] == BODY["inertia_about_centroid"], r)
    check("with a word about it", r["checks"]["orientation"] == "inward"
          and "inside_out" in warnings(r) and r["checks"]["closed"]
          and r["checks"]["solid"] is False, r["checks"])


def test_bodies(d):
    small = box((100, 0, 0), (1, 1, 1))
    r = report(d, BOX + small)
    b = r["bodies"]
    check("two bodies", r["mesh"]["bodies"] == 2 and [x["volume"] for x in b] == [24000, 1]
          and b[1]["bounding_box"] == {"min": [100, 0, 0], "max": [101, 1, 1]}
          and r["properties"]["volume"] == 24001 and r["checks"]["solid"] is True, r)
    check("are listed by their smallest triangle",
          [x["volume"] for x in report(d, small + BOX)["bodies"]] == [1, 24000])
    hole = box((10, 10, 5), (10, 10, 10))
    r = report(d, BOX + flip(hole))
    b = r["bodies"]
    check("a cavity is subtracted", r["properties"]["volume"] == 23000 and b[1]["cavity"] is True
          and b[1]["depth"] == 1 and b[1]["parent"] == 0 and b[0]["depth"] == 0
          and b[1]["orientation"] == "inward" and r["checks"]["orientation"] == "outward", r)
    r = report(d, flip(hole) + BOX)
    check("whichever comes first", r["properties"]["volume"] == 23000
          and r["bodies"][0]["cavity"] is True and r["bodies"][0]["parent"] == 1, r)
    r = report(d, BOX + hole)
    check("one wound outward counts twice, with a warning", r["properties"]["volume"] == 25000
          and "cavity_outward" in warnings(r) and r["checks"]["solid"] is False
          and r["checks"]["orientation"] == "mixed", r)
    beside = report(d, BOX + flip(box((100, 0, 0), (1, 1, 1))))
    check("one inside out beside a good one is mixed", beside["checks"]["orientation"] == "mixed"
          and "mixed_bodies" in warnings(beside) and beside["checks"]["solid"] is False, beside)


def located(r, kind):
    return [(x["triangles"], x["vertices"]) for x in at(r, "defects." + kind)]


def test_defects(d):
    r = report(d, BOX[2:])
    edges, loops = located(r, "boundary_edges"), located(r, "boundary_loops")
    rim = {(0, 0, 0), (40, 0, 0), (40, 30, 0), (0, 30, 0)}
    check("boundary edges are located", len(edges) == 4 and {tuple(v) for _, e in edges for v in e}
          == rim and all(len(t) == 1 and len(v) == 2 for t, v in edges), edges)
    check("the loop too", len(loops) == 1 and {tuple(v) for v in loops[0][1]} == rim
          and sorted(loops[0][0]) == sorted(t for e in edges for t in e[0]), loops)
    r = report(d, [BOX[0][::-1]] + BOX[1:])
    check("a triangle turned round", r["checks"]["misoriented_edges"] == 3
          and len(located(r, "misoriented_edges")) == 3 and r["properties"]["volume"] is None
          and "inconsistent_winding" in warnings(r)
          and all(0 in t for t, _ in located(r, "misoriented_edges")), r)
    r = report(d, BOX + BOX[:1])
    check("a triangle twice", r["checks"]["duplicate_triangles"] == 1
          and located(r, "duplicate_triangles")[0][0] == [0, 12]
          and r["checks"]["non_manifold_edges"] == 3, r["defects"])
    point = ((5, 5, 0),) * 3
    r = report(d, BOX + [point])
    check("a point for a triangle", r["checks"]["degenerate_triangles"] == 1
          and located(r, "degenerate_triangles")[0][0] == [12]
          and r["properties"]["volume"] == 24000, r)
    r = report(d, BOX + box((40, 30, 0), (1, 1, 20)))
    check("an edge of two boxes", r["checks"]["closed"] and r["properties"]["volume"] == 24020
          and r["checks"]["non_manifold_edges"] >= 1 and not r["checks"]["watertight"]
          and located(r, "non_manifold_edges"), r["checks"])
    r = report(d, BOX + box((40, 30, 20), (1, 1, 1)))
    check("a corner of two boxes", r["checks"]["watertight"]
          and r["checks"]["non_manifold_vertices"] == 1
          and located(r, "non_manifold_vertices")[0][1] == [[40, 30, 20]], r["defects"])
    wrong = stl(BOX)[:84] + struct.pack("<3f", 0, 0, 1) + stl(BOX)[96:]
    r = report(d, None, data=wrong)
    check("a stored normal that contradicts its facet", r["checks"]["normals_disagreeing"] == 1
          and "normals_disagreeing" in warnings(r) and r["properties"]["volume"] == 24000, r)


def test_names(d):
    def name(data):
        a = d.post(data, query="unit=mm")
        a.body.decode("utf-8", "strict")
        return at(a.json, "bodies.0.name")

    check("a solid's name", name(stl_ascii(BOX, "left bracket")) == "left bracket")
    check("no name", name(stl_ascii(BOX, "")) is None)
    odd = 'a "b" \\ / c <script>'
    for what, text in (("that JSON must escape", odd), ("in UTF-8", "Fl\u00fcgel \U0001f600")):
        got = name(stl_ascii(BOX, text))
        check(f"a name {what}", got == text, got)
    got = name(stl_ascii(BOX, "NAME").replace(b"NAME", b"caf\xe9 \xff\xc3(\xed\xa0\x80\tx"))
    check("a name that is no UTF-8 is still good JSON", isinstance(got, str)
          and got.startswith("caf\ufffd ") and got.endswith("x") and "\t" not in got, repr(got))
    a = d.post(stl(BOX, b"solid \xff\xfe\x00 \x80" * 5), query="unit=mm")
    check("a header that begins like text and is not", a.status == 200
          and a.json["input"]["format"] == "stl-binary", a)
    two = stl_ascii(BOX, "one") + stl_ascii(box((100, 0, 0), (1, 1, 1)), "two")
    r = report(d, None, "unit=mm", two)
    check("two solids are one part", [b["name"] for b in r["bodies"]] == ["one", "two"]
          and r["properties"]["volume"] == 24001 and "several_solids" in warnings(r), r)


with Daemon("--workers", "1") as daemon:
    test_example(daemon)
    test_wedge(daemon)
    test_null_rules(daemon)
    test_inside_out(daemon)
    test_bodies(daemon)
    test_defects(daemon)
    test_names(daemon)
finish()
