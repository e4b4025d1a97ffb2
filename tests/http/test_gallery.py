#!/usr/bin/env python3
"""One mesh, built by construction, for each warning (warning_CODE, which tests/check/docs asks for)
and each kind of defect: what the report says of it, exactly."""
from urllib.parse import quote

from harness import *

LOW, SIZE = (0, 0, 0), (40, 30, 20)
BOX = box(LOW, SIZE)  # bottom, lid, front, back, left, right: two triangles each
NO_LID = BOX[:2] + BOX[4:]
GOOD = {"closed": True, "watertight": True, "winding_consistent": True, "orientation": "outward",
        "solid": True, "boundary_edges": 0, "boundary_loops": 0, "non_manifold_edges": 0,
        "non_manifold_vertices": 0, "misoriented_edges": 0, "degenerate_triangles": 0,
        "duplicate_triangles": 0, "duplicates_same": 0, "duplicates_opposite": 0,
        "double_walls": 0, "single_walls": 0, "normals_disagreeing": 0,
        "closure_defect": [0, 0, 0]}
SHUT = {"closed": False, "watertight": False, "orientation": "none", "solid": False}
PLACES = ("boundary_edges", "boundary_loops", "non_manifold_edges", "non_manifold_vertices",
          "misoriented_edges", "degenerate_triangles", "duplicate_triangles")


def obj(*lines):
    return ("\n".join(lines) + "\n").encode()


OBJ_BOX = [f"v {x} {y} {z}" for z in (0, 1) for y in (0, 1) for x in (0, 1)] + [
    "f 1 3 4 2", "f 5 6 8 7", "f 1 2 6 5", "f 3 7 8 4", "f 1 5 7 3", "f 2 4 8 6"]


def named_stl(**solids):
    return b"".join(stl_ascii(mesh, name) for name, mesh in solids.items())


def faults(a, warned, checks, **properties):
    """What the answer says otherwise: of the warnings (all of them), the checks (where ${checks} is
    silent those of a good solid), and the properties that are named."""
    if a.status != 200:
        return [str(a)]
    r, out = a.json, []
    codes = {w["code"] for w in r["warnings"]}
    if codes != warned:
        out.append(f"warnings {sorted(codes)}, not {sorted(warned)}")
    for name, value in {**GOOD, **checks}.items():
        if r["checks"][name] != value:
            out.append(f"checks.{name} {r['checks'][name]}, not {value}")
    for name, value in properties.items():
        if r["properties"][name] != value:
            out.append(f"properties.{name} {r['properties'][name]}, not {value}")
    for kind in PLACES:
        if not r["defects"]["truncated"] and len(r["defects"][kind]) != r["checks"][kind]:
            out.append(f"{len(r['defects'][kind])} {kind} are listed")
    return out


def show(name, a, warned, checks, **properties):
    wrong = faults(a, warned, checks, **properties)
    check(name, not wrong, "\n".join(wrong))
    return a.json["defects"] if a.status == 200 else {}


def post(d, mesh, query="unit=mm"):
    return d.post(mesh if isinstance(mesh, bytes) else stl(mesh), query=query)


# ------------------------------------------------------------------------------------- warnings


def warning_open_mesh(d):
    found = show("a box without its lid", post(d, NO_LID), {"open_mesh"},
                 {**SHUT, "boundary_edges": 4, "boundary_loops": 1, "closure_defect": [0, 0, -1200]},
                 volume=None, surface_area=4000, volume_if_capped=24000, cap_area=1200)
    want = {"edge_count": 4, "vertex_count": 4, "simple": True, "length": 140, "area": 1200,
            "planar": True, "plane_deviation": 0, "crack": False, "t_junctions": [],
            "bounding_box": {"min": [0, 0, 20], "max": [40, 30, 20]}}
    loop = found["boundary_loops"][0]
    check("its rim", {k: loop[k] for k in want} == want and len(loop["triangles"]) == 4
          and sorted(loop["vertices"]) == [[0, 0, 20], [0, 30, 20], [40, 0, 20], [40, 30, 20]], loop)


def warning_cracks(d):
    a, b, c = BOX[0]
    m = tuple((x + y) / 2 for x, y in zip(a, b))
    found = show("a box with a T-junction", post(d, [(a, m, c), *BOX[1:], (m, b, c)]), {"cracks"},
                 {**SHUT, "boundary_edges": 3, "boundary_loops": 1},
                 volume=24000, surface_area=5200, centroid=[20, 15, 10], volume_if_capped=None,
                 cap_area=None)
    loop = found["boundary_loops"][0]
    check("which is a crack of no area, and where", loop["crack"] and loop["simple"]
          and loop["area"] == 0 and loop["planar"] and loop["plane_deviation"] is None
          and loop["length"] == 2 * math.dist(a, b)
          and loop["t_junctions"] == [{"vertex": list(m), "edge": [list(a), list(b)]}], loop)
    turned = "unit=mm&transform=0.6,-0.8,0,7.1,0.8,0.6,0,0.3,0,0,1.7,1e-3"
    loop = post(d, [(a, m, c), *BOX[1:], (m, b, c)], turned).json["defects"]["boundary_loops"][0]
    check("and one still when it is turned", loop["crack"] and loop["area"] == 0
          and len(loop["t_junctions"]) == 1, loop)


def warning_inconsistent_winding(d):
    mesh = [(BOX[0][0], BOX[0][2], BOX[0][1])] + BOX[1:]
    show("a box with a triangle turned round", post(d, mesh), {"inconsistent_winding"},
         {**SHUT, "watertight": True, "winding_consistent": False, "misoriented_edges": 3,
          "closure_defect": [0, 0, 1200]}, volume=None, volume_if_capped=None)


def warning_non_manifold_edges(d):
    show("two boxes that share an edge", post(d, BOX + box((40, 30, 0), (10, 10, 20))),
         {"non_manifold_edges"}, {"watertight": False, "non_manifold_edges": 1}, volume=26000)


def warning_non_manifold_vertices(d):
    found = show("two boxes that share a corner", post(d, BOX + box((40, 30, 20), (10, 10, 10))),
                 {"non_manifold_vertices"}, {"non_manifold_vertices": 1}, volume=25000)
    check("which one", found["non_manifold_vertices"][0]["vertices"] == [[40, 30, 20]], found)


def warning_inside_out(d):
    show("a box inside out", post(d, flip(BOX)), {"inside_out"},
         {"orientation": "inward", "solid": False}, volume=24000, signed_volume=-24000)


def warning_mixed_bodies(d):
    show("a box beside one that is inside out", post(d, BOX + flip(box((50, 0, 0), (10, 10, 10)))),
         {"mixed_bodies"}, {"orientation": "mixed", "solid": False}, volume=23000)


def warning_cavity_outward(d):
    a = post(d, BOX + box((10, 10, 5), (10, 10, 10)))
    codes = {w["code"] for w in a.json["warnings"]}
    check("a box in a box, both outward", "cavity_outward" in codes
          and a.json["properties"]["volume"] == 25000 and a.json["checks"]["solid"] is False
          and [b["depth"] for b in a.json["bodies"]] == [0, 1], a)


def warning_zero_volume(d):
    a, b, c, e = (0, 0, 0), (40, 0, 0), (40, 30, 0), (0, 30, 0)
    show("a rectangle with two sides", post(d, [(a, b, c), (a, c, e), (a, e, b), (b, e, c)]),
         {"zero_volume"}, {"orientation": "none", "solid": False}, volume=0, centroid=None,
         surface_area=2400)


def warning_out_of_range(d):
    mesh = stl_ascii(box((0, 0, 0), (1e150,) * 3))
    a = post(d, mesh)
    show("a box whose volume is 1e450", a, {"out_of_range"}, {}, volume=None, inertia=None)
    check("its area is given", math.isclose(a.json["properties"]["surface_area"], 6e300,
                                            rel_tol=1e-15), a)


def warning_degenerate_triangles(d):
    a, b, _ = BOX[0]
    found = show("a triangle on two points", post(d, BOX + [(a, a, b)]), {"degenerate_triangles"},
                 {"degenerate_triangles": 1}, volume=24000)
    check("which one", found["degenerate_triangles"][0]["triangles"] == [12], found)
    o, x = (0, 0, 0), (1, 0, 0)
    a = post(d, [(o, o, x), (o, x, x)])
    warned = {w["code"] for w in a.json["warnings"]}
    check("a mesh of nothing else has no edge and so no winding to warn of",
          warned == {"degenerate_triangles"}, warned)


def warning_duplicate_triangles(d):
    found = show("a triangle twice", post(d, BOX + [BOX[0]]),
                 {"duplicate_triangles", "non_manifold_edges", "inconsistent_winding"},
                 {**SHUT, "non_manifold_edges": 3, "duplicate_triangles": 1, "duplicates_same": 1,
                  "closure_defect": [0, 0, -600]}, volume=None, volume_if_capped=None)
    item = found["duplicate_triangles"][0]
    check("which ones", item["triangles"] == [0, 12] and item["opposite"] is False, item)


def warning_normals_disagreeing(d):
    def facet(normal, t):
        return struct.pack("<12fH", *normal, *t[0], *t[1], *t[2], 0)

    def normal(t):
        u, v = ([t[i][k] - t[0][k] for k in range(3)] for i in (1, 2))
        return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]

    def file(normals):
        return bytes(80) + struct.pack("<I", 12) + b"".join(map(facet, normals, BOX))

    true = [normal(t) for t in BOX]
    show("a stored normal reversed", post(d, file([[-x for x in true[0]]] + true[1:])),
         {"normals_disagreeing"}, {"normals_disagreeing": 1}, volume=24000)
    show("all of them: the winding decides", post(d, file([[-x for x in n] for n in true])),
         {"normals_disagreeing"}, {"normals_disagreeing": 12}, volume=24000)
    show("zero normals agree", post(d, file([[0, 0, 0]] * 12)), set(), {})
    show("so do normals at a right angle, tilted or long ones",
         post(d, file([[1e3 * x + y for x, y in zip(n, (0.5, 0.25, 0.125))] for n in true[:6]]
                      + [[n[1], n[2], n[0]] for n in true[6:]])), set(), {})
    show("an infinite one is none", post(d, file([[-math.inf, 0, 0]] * 12)), set(), {})
    a, b, _ = BOX[0]
    slit = bytes(80) + struct.pack("<I", 13) + b"".join(map(facet, true, BOX)) + facet((0, 0, 1),
                                                                                     (a, a, b))
    show("nothing contradicts a triangle without area", post(d, slit), {"degenerate_triangles"},
         {"degenerate_triangles": 1})


def warning_trailing_bytes(d):
    show("bytes behind the last facet", post(d, stl(BOX) + b"abc"), {"trailing_bytes"}, {},
         volume=24000)


def warning_missing_endsolid(d):
    show("a text STL that does not end", post(d, stl_ascii(BOX).rpartition(b"endsolid")[0]),
         {"missing_endsolid"}, {}, volume=24000)


def warning_nonstandard_lines(d):
    text = stl_ascii(BOX).replace(b"endfacet", b"endfacet color 1 2 3", 1)
    show("a line that is none of STL's", post(d, text), {"nonstandard_lines"}, {}, volume=24000)


def warning_several_solids(d):
    show("two solids in one file", post(d, named_stl(a=BOX, b=box((50, 0, 0), (10, 10, 10)))),
         {"several_solids"}, {}, volume=25000)


def warning_nesting_undecided(d):
    x, y, z = ((0, 15, 10), (40, 15, 10)), ((20, 0, 10), (20, 30, 10)), ((20, 15, 0), (20, 15, 20))
    octahedron = [(x[i], y[j], z[k]) if (i + j + k) % 2 else (x[i], z[k], y[j])
                  for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    a = post(d, BOX + octahedron)
    codes = {w["code"] for w in a.json["warnings"]}
    check("an octahedron in a box, every corner on a face of it", "nesting_undecided" in codes
          and a.json["properties"]["volume"] == 28000 and a.json["checks"]["solid"] is not True, a)


def warning_defects_truncated(d):
    a = post(d, BOX[1:11], "unit=mm&defects=1")
    show("more defects than were asked for", a, {"open_mesh", "defects_truncated"},
         {**SHUT, "boundary_edges": 6, "boundary_loops": 2, "closure_defect": [-300, 0, 600]},
         volume_if_capped=24000)
    check("one of each is listed", len(a.json["defects"]["boundary_edges"]) == 1
          and len(a.json["defects"]["boundary_loops"]) == 1 and a.json["defects"]["truncated"], a)


def warning_named_against(d):
    mesh = named_stl(a=BOX, b=flip(box((50, 0, 0), (10, 10, 10))))
    query = "unit=mm&density_unit=file&" + quote("density[a]") + "=1&" + quote("density[b]") + "=2"
    show("named solids wound against each other", post(d, mesh, query),
         {"named_against", "mixed_bodies", "several_solids"},
         {"orientation": "mixed", "solid": False}, volume=23000, mass=26000)


def warning_nonplanar_polygons(d):
    a = post(d, obj(*(line.replace("v 1 1 1", "v 1 1 2") for line in OBJ_BOX)))
    show("a box with a corner lifted", a, {"nonplanar_polygons"}, {})
    volume = a.json["properties"]["volume"]
    check("its volume is that of one of the diagonals",
          min(abs(volume - 4 / 3), abs(volume - 7 / 6)) < 1e-15, volume)


def warning_tangled_polygons(d):
    a = post(d, obj("v 0 0 0", "v 1 1 0", "v 1 0 0", "v 0 2 0", "f 1 2 3 4"))
    codes = {w["code"] for w in a.json["warnings"]}
    check("a bow tie", codes == {"tangled_polygons", "open_mesh"}, a)


def warning_nul_bytes(d):
    show("an OBJ file filled up with NULs", post(d, obj(*OBJ_BOX) + bytes(100)), {"nul_bytes"}, {},
         volume=1)


def warning_nearly_closed(d):
    step = 2 ** -18  # of a float32 between 32 and 64, where the largest coordinate is
    torn = [BOX[0][:2] + ((BOX[0][2][0], BOX[0][2][1] + 2 ** -19, BOX[0][2][2]),)] + BOX[1:]
    a = post(d, torn)
    check("a corner one step away", {w["code"] for w in a.json["warnings"]} ==
          {"nearly_closed", "open_mesh"} and a.json["properties"]["volume"] is None
          and a.json["checks"]["closes_at_tolerance"] == step, a)
    show("welded at what the report says", post(d, torn, f"unit=mm&weld={step!r}"), set(),
         {"closes_at_tolerance": None}, volume=24000)
    far = [tuple(tuple(x + (1 if x == 20 else 0) for x in p) for p in t) for t in NO_LID]
    show("a box without its lid is not", post(d, far), {"open_mesh"},
         {**SHUT, "boundary_edges": 4, "boundary_loops": 1, "closure_defect": [0, 0, -1200],
          "closes_at_tolerance": None})


def warning_non_orientable(d):
    n, points = 9, []
    for i in range(n + 1):
        a, side = math.tau * (i % n) / n, -1 if i == n else 1
        points.append([((10 + s * math.cos(a / 2)) * math.cos(a),
                        (10 + s * math.cos(a / 2)) * math.sin(a), s * math.sin(a / 2))
                       for s in (-side, side)])
    quads = [(*points[i], *points[i + 1][::-1]) for i in range(n)]
    strip = [t for p, q, r, s in quads for t in ((p, q, r), (p, r, s))]
    a = post(d, strip)
    check("a Moebius strip", {w["code"] for w in a.json["warnings"]} ==
          {"non_orientable", "open_mesh", "inconsistent_winding"}
          and a.json["bodies"][0]["orientable"] is False
          and a.json["checks"]["boundary_loops"] == 1, a)


def warning_weld_undecided(d):
    """A rod and a ring round it, just out of reach of each other, as boxes cannot tell."""
    count, radius, points = 180000, 1.000001, []
    for i in range(count):
        a, s = math.tau * i / count, (i / count - 0.5) * 0.01
        u, v = radius * math.cos(a) / math.sqrt(2), radius * math.sin(a) / math.sqrt(6)
        points.append((s, s, s) if i % 2 == 0 else (u + v, v - u, -2 * v))
    a = post(d, [tuple(points[i:i + 3]) for i in range(0, count, 3)], "unit=mm&weld=1&defects=0")
    check("two clouds at nearly the weld distance", a.status == 200
          and "weld_undecided" in {w["code"] for w in a.json["warnings"]}, a)


def warning_internal_walls(d):
    found = show("two boxes glued together", post(d, BOX + box((40, 0, 0), SIZE)),
                 {"internal_walls", "non_manifold_edges", "duplicate_triangles"},
                 {"watertight": False, "non_manifold_edges": 5, "duplicate_triangles": 2,
                  "duplicates_opposite": 2, "double_walls": 1}, volume=48000,
                 surface_area=2 * 5200, centroid=[40, 15, 10])
    check("the wall is where", [(i["triangles"], i["opposite"]) for i in
                                found["duplicate_triangles"]] == [([10, 21], True), ([11, 20], True)],
          found["duplicate_triangles"])
    left, right = BOX[:10], [t for i, t in enumerate(box((40, 0, 0), SIZE)) if i not in (8, 9)]
    show("without the wall", post(d, left + right), set(), {}, volume=48000,
         surface_area=2 * 5200 - 1200)
    show("with a single wall", post(d, left + right + BOX[10:]),
         {"internal_walls", "non_manifold_edges"},
         {**SHUT, "non_manifold_edges": 4, "single_walls": 1, "closure_defect": [600, 0, 0]},
         volume=None, volume_if_capped=None)
    show("with half of a wall, which has a free edge", post(d, left + right + BOX[10:11]),
         {"open_mesh", "non_manifold_edges"},
         {**SHUT, "boundary_edges": 1, "boundary_loops": 1, "non_manifold_edges": 2,
          "closure_defect": [300, 0, 0]}, volume_if_capped=None)
    half = [(a, c, b) for a, b, c in BOX[10:11]]
    show("and with two sides: a fin", post(d, left + right + BOX[10:11] + half),
         {"duplicate_triangles", "non_manifold_edges"},
         {"watertight": False, "non_manifold_edges": 2, "duplicate_triangles": 1,
          "duplicates_opposite": 1}, volume=48000)


def warning_overlapping_bodies(d):
    found = show("two boxes of which one reaches into the other",
                 post(d, BOX + box((30, 20, 10), SIZE)), {"overlapping_bodies"},
                 {"overlapping_bodies": 1, "solid": False}, volume=48000)
    place, = found["overlapping_bodies"]
    check("where", place["triangles"][0] < 12 <= place["triangles"][1] < 24
          and len(place["vertices"]) == 2 and found["self_intersections"] == []
          and all(30 <= x <= 40 and 20 <= y <= 30 and 10 <= z <= 20
                  for x, y, z in place["vertices"]), place)
    show("the same mapped", post(d, BOX + box((30, 20, 10), SIZE),
                                 "unit=mm&transform=0,-2,0,5,2,0,0,0,0,0,2,0"),
         {"overlapping_bodies"}, {"overlapping_bodies": 1, "solid": False}, volume=8 * 48000)
    for name, low, size in (("a face", (40, 5, 5), (10, 10, 10)), ("an edge", (40, 30, 5), (9, 9, 9)),
                            ("nothing", (41, 0, 0), SIZE)):
        show(f"two boxes that have {name} in common", post(d, BOX + box(low, size)), set(),
             {"overlapping_bodies": 0}, volume=24000 + size[0] * size[1] * size[2])
    show("a cavity", post(d, BOX + inside_out(box((5, 5, 5), (5, 5, 5)))), set(),
         {"overlapping_bodies": 0}, volume=24000 - 125)
    show("a box round which an L of two lies", post(d, l_shape() + box((12, 12, 2), (4, 4, 4))), set(),
         {"overlapping_bodies": 0}, volume=3000 + 64)


def inside_out(mesh):
    return [(a, c, b) for a, b, c in mesh]


def l_shape():
    """A prism 10 high: 20 x 20 without the quarter in which x and y are above 10."""
    p = [(0, 0), (20, 0), (20, 10), (10, 10), (10, 20), (0, 20)]
    mesh = []
    for i in range(6):
        (x, y), (u, v) = p[i], p[(i + 1) % 6]
        mesh += [((x, y, 0), (u, v, 0), (u, v, 10)), ((x, y, 0), (u, v, 10), (x, y, 10))]
    for a, b, c in ((0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)):
        mesh += [tuple((*p[i], 10) for i in (a, b, c)), tuple((*p[i], 0) for i in (a, c, b))]
    return mesh


def warning_overlap_undecided(d):
    a = post(d, NO_LID + box((30, 20, 10), SIZE))
    codes = {w["code"] for w in a.json["warnings"]}
    check("a box without its lid and another one across its rim", codes == {
        "open_mesh", "overlap_undecided"} and a.json["checks"]["overlapping_bodies"] is None, a)


def warning_self_intersecting(d):
    query = "unit=mm&include=self_intersections"
    a = post(d, BOX + box((30, 20, 10), SIZE), query)
    n = a.json["checks"]["self_intersections"]
    found = show("two boxes of which one reaches into the other", a,
                 {"overlapping_bodies", "self_intersecting"},
                 {"overlapping_bodies": 1, "solid": False, "self_intersections": n}, volume=48000)
    pairs = [p["triangles"] for p in found["self_intersections"]]
    check("where", 6 <= n == len(pairs) and pairs == sorted(pairs), found)
    a = post(d, BOX + box((5, 5, 20), (10, 10, 10)), query)
    n = a.json["checks"]["self_intersections"]  # the floor of one and its rim on the lid of the other
    show("a box on a box", a, {"self_intersecting"},
         {"overlapping_bodies": 0, "self_intersections": n}, volume=25000)
    check("some meet", n >= 2, a)
    show("a box", post(d, BOX, query), set(), {"self_intersections": 0}, volume=24000)
    a = post(d, BOX + box((30, 20, 10), SIZE), query + "&defects=1")
    check("only so many are listed", a.json["defects"]["truncated"]
          and len(a.json["defects"]["self_intersections"]) == 1
          and "defects_truncated" in {w["code"] for w in a.json["warnings"]}, a)


def warning_self_intersections_undecided(d):
    mesh = []
    for i in range(10000):
        s, w = i / 10000, 1e-4
        mesh += [((-1, s, -s), (1, -s, s), (1, w - s, s + w)),
                 ((s, -1, s), (-s, 1, -s), (w - s, 1, w - s))]
    a = post(d, mesh, "unit=mm&defects=5&include=self_intersections")
    codes = {w["code"] for w in a.json["warnings"]} if a.status == 200 else {}
    check("20,000 needles that all cross", "self_intersections_undecided" in codes
          and "self_intersecting" in codes and a.json["checks"]["self_intersections"] is None
          and len(a.json["defects"]["self_intersections"]) == 5, a)


def warning_not_closed(d):
    a = post(d, NO_LID, "unit=mm&checks=closed")
    check("a box without its lid, looked at without a table", a.status == 200
          and {w["code"] for w in a.json["warnings"]} == {"not_closed"}
          and a.json["checks"]["closed"] is False and a.json["properties"]["volume"] is None
          and a.json["checks"]["closure_defect"] == [0, 0, -1200] and a.json["defects"] is None, a)


def warning_unit_assumed(d):
    show("a mesh without a unit", post(d, BOX, ""), {"unit_assumed"}, {}, volume=24000)


def warning_attachment_ignored(d):
    with tempfile.TemporaryDirectory() as tmp:
        paths = [os.path.join(tmp, name) for name in ("box.stl", "box.mtl")]
        for path, data in zip(paths, (stl(BOX), b"newmtl red\n")):
            with open(path, "wb") as f:
                f.write(data)
        a = d.curl("/v1/mass-properties?unit=mm", "-F", f"file=@{paths[0]}", "-F",
                   f"more=@{paths[1]}")
    show("a form with a material library", a, {"attachment_ignored"}, {}, volume=24000)


# ------------------------------------------------------------------------- holes and duplicates


def loops_of(d, mesh, query="unit=mm"):
    a = post(d, mesh, query)
    return a.json["defects"]["boundary_loops"], a.json["properties"], a


def test_loops(d):
    """Of all shapes, far from the origin too."""
    far = stl_ascii([tuple(tuple(x + 1e6 for x in p) for p in t) for t in NO_LID])
    loops, p, a = loops_of(d, far)
    check("a hole a million units away", p["volume_if_capped"] == 24000 and p["cap_area"] == 1200
          and (loops[0]["length"], loops[0]["area"], loops[0]["plane_deviation"]) == (140, 1200, 0), a)
    loops, p, a = loops_of(d, flip(NO_LID))
    check("a box inside out, without its lid", p["volume_if_capped"] == 24000, a)
    loops, p, a = loops_of(d, BOX[:2] + BOX[4:10])  # without lid and right side
    check("a hole that is not flat", len(loops) == 1 and not loops[0]["planar"]
          and loops[0]["edge_count"] == 6 and loops[0]["length"] == 180
          and math.isclose(loops[0]["area"], math.hypot(600, 1200), rel_tol=1e-15)
          and loops[0]["plane_deviation"] > 1, a)
    # the fan's tip is the mean of the six corners
    tip = [sum(x) / 6 for x in zip((0, 0, 20), (40, 0, 20), (40, 0, 0), (40, 30, 0), (40, 30, 20),
                                   (0, 30, 20))]
    # what is cut off the box: the tip as seen from both missing faces
    lost = (600 * (40 - tip[0]) + 1200 * (20 - tip[2])) / 3
    check("is estimated", math.isclose(p["volume_if_capped"], 24000 - lost, rel_tol=1e-14), p)
    loops, p, a = loops_of(d, BOX[:1])
    check("a triangle alone: capped, it is nothing", p["volume_if_capped"] == 0
          and p["cap_area"] == 600 and loops[0]["area"] == 600, a)
    a, b, c, e, f = (0, 0, 0), (3, 0, 0), (0, 4, 0), (-3, 0, 0), (0, -4, 0)
    loops, p, answer = loops_of(d, [(a, b, c), (a, e, f)])
    check("two triangles at a point: no circle, one area", len(loops) == 1
          and not loops[0]["simple"] and loops[0]["edge_count"] == 6 and loops[0]["vertex_count"] == 5
          and loops[0]["length"] == 24 and loops[0]["area"] == 12 and loops[0]["planar"], answer)
    loops, p, answer = loops_of(d, [(a, b, c), (a, f, e)])
    check("and wound against each other: none", loops[0]["area"] == 0
          and loops[0]["plane_deviation"] is None and not loops[0]["planar"]
          and not loops[0]["crack"], answer)
    loops, p, answer = loops_of(d, [(a, b, c), (a, c, e)[::-1]])
    check("a circle whose triangles are wound against each other has its area",
          loops[0]["simple"] and loops[0]["area"] == 12 and p["volume_if_capped"] is None, answer)
    ring = [(math.cos(i * math.tau / 2000), math.sin(i * math.tau / 2000), 0.0) for i in range(2000)]
    cone = [(ring[i], ring[(i + 1) % 2000], (0.0, 0.0, 1.0)) for i in range(2000)]
    loops, p, answer = loops_of(d, stl_ascii(cone))
    area = 1000 * math.sin(math.tau / 2000)
    check("a loop is measured over all of it, though not all is listed",
          len(loops[0]["vertices"]) == 1024 and loops[0]["vertex_count"] == 2000
          and answer.json["defects"]["truncated"]
          and math.isclose(loops[0]["length"], 4000 * math.sin(math.pi / 2000), rel_tol=1e-14)
          and math.isclose(loops[0]["area"], area, rel_tol=1e-14)
          and math.isclose(p["volume_if_capped"], area / 3, rel_tol=1e-14), answer)


def test_duplicates(d):
    turned, back = BOX[0][1:] + BOX[0][:1], BOX[0][::-1]
    a = post(d, BOX + [turned, back, back])
    c = a.json["checks"]
    check("two one way round and two the other", c["duplicate_triangles"] == 3
          and c["duplicates_opposite"] == 2 and c["duplicates_same"] == 1, a)
    found = [(i["triangles"], i["opposite"]) for i in a.json["defects"]["duplicate_triangles"]]
    check("each against the earliest", found == [([0, 12], False), ([0, 13], True), ([0, 14], True)],
          found)
    a = post(d, BOX + flip(BOX))
    c = a.json["checks"]
    check("a body there twice, the other way round, is no wall", c["duplicates_opposite"] == 12
          and c["double_walls"] == 0 and c["closed"] and a.json["properties"]["volume"] == 0, a)


with Daemon("--workers", "1") as daemon:
    for function in [f for name, f in sorted(globals().items())
                     if name.startswith(("warning_", "test_"))]:
        function(daemon)
finish()
