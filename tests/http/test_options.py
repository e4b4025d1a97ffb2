#!/usr/bin/env python3
"""Every option with a value that changes the answer, and every way to get one wrong."""
from urllib.parse import quote

from contract import *
from harness import *
from wire import *

BOX = box((0, 0, 0), (40, 30, 20))
FILE = stl(BOX)
OPEN = stl(BOX[2:])
INCH3, POUND = 16387.064e-9, 0.45359237  # m3, kg: by definition

# query: {path into the report: value}; numbers to 1e-12
GOOD = {
    "unit=um": {"units.length": "um", "properties.volume": 24000, "input.unit": "um"},
    "unit=cm&density=2700": {"properties.mass": 64.8, "units.inertia": "kg.cm2"},
    "unit=m&density=2700": {"properties.mass": 64800000, "units.area": "m2"},
    "unit=in&density=2700": {"properties.mass": 24000 * INCH3 * 2700, "units.volume": "in3"},
    "unit=ft&density=2700": {"properties.mass": 24000 * INCH3 * 1728 * 2700},
    "unit=um&density=2700": {"properties.mass": 6.48e-11},
    "density=2700": {"properties.mass": 0.0648, "properties.density": 2700},
    "density=2.7e3": {"properties.mass": 0.0648},
    "density=%32%37%30%30": {"properties.mass": 0.0648},
    "density=2.7e%2B3": {"properties.mass": 0.0648},
    "density=2.7&density_unit=g/cm3": {"properties.mass": 0.0648, "units.density": "g/cm3",
                                       "properties.density": 2.7},
    "density=0.1&density_unit=lb%2Fin3": {"properties.mass": 24000e-9 * 0.1 * POUND / INCH3,
                                          "properties.density": 0.1},
    "density=2.5&density_unit=file": {"properties.mass": 60000, "units.mass": "file",
                                      "units.density": "file", "units.inertia": "file.mm2",
                                      "properties.inertia.about_centroid.0.0": 6500000,
                                      "properties.density": 2.5},
    "density=1&density_unit=file&unit=in": {"properties.mass": 24000, "units.inertia": "file.in2"},
    "material=steel": {"properties.density": 7850, "properties.mass": 0.1884},
    "material=steel&density_unit=g/cm3": {"properties.density": 7.85, "properties.mass": 0.1884},
    "mass=0.0648": {"properties.density": 2700, "properties.mass": 0.0648,
                    "properties.inertia.about_centroid.0.0": 7.02},
    "mass=64.8&mass_unit=g": {"properties.density": 2700, "units.mass": "g",
                              "units.inertia": "g.mm2",
                              "properties.inertia.about_centroid.2.2": 13500},
    "density=2700&mass_unit=g": {"properties.mass": 64.8},
    "density=2700&mass_unit=lb": {"properties.mass": 0.0648 / POUND, "units.mass": "lb"},
    "mass=1&mass_unit=lb": {"properties.mass": 1, "properties.density": POUND / 24000e-9},
    "density=2700&about=0,0,0": {"properties.inertia.about_point.0": [28.08, -19.44, -12.96]},
    "density=2700&about=20,15,10": {"properties.inertia.about_point.0": [7.02, 0, 0]},
    "density=2700&about=20,15,11": {"properties.inertia.about_point.0.0": 7.02 + 0.0648},
    "density=2700&axis=0,0,1": {"properties.inertia.about_axis": {
        "origin": [0, 0, 0], "direction": [0, 0, 1], "moment": 54,
        "radius_of_gyration": (54 / 0.0648) ** 0.5}},
    "density=2700&axis=0,0,-5e-3": {"properties.inertia.about_axis.direction": [0, 0, -1],
                                    "properties.inertia.about_axis.moment": 54},
    "density=2700&axis_origin=20,15,10": {"properties.inertia.about_axis.moment": 13.5,
                                          "properties.inertia.about_axis.direction": [0, 0, 1]},
    "density=2700&axis=1,0,0&axis_origin=7,15,10": {"properties.inertia.about_axis.moment": 7.02,
                                                    "properties.inertia.about_axis.origin":
                                                        [7, 15, 10]},
    "density=2700&axis=1,1,0&axis_origin=20,15,10": {
        "properties.inertia.about_axis.moment": (7.02 + 10.8) / 2},
    "axis=0,0,1": {"properties.inertia.about_axis.moment": 20000000},
    "flip=true": {"properties.volume": 24000, "properties.signed_volume": -24000,
                  "checks.orientation": "inward", "repairs.flipped_triangles": 12},
    "flip=false": {"properties.signed_volume": 24000, "repairs.flipped_triangles": 0},
    "weld=0": {"repairs.welded_vertices": 0, "mesh.vertices": 8},
    "weld=20": {"repairs.welded_vertices": 0, "mesh.vertices": 8},  # nearer than this, not at it
    "weld=20.5": {"repairs.welded_vertices": 4, "mesh.vertices": 4, "properties.volume": 0,
                  "checks.degenerate_triangles": 8, "mesh.bounding_box.max": [40, 30, 0]},
    "format=stl": {"input.format": "stl-binary"},
    "format=auto": {"input.format": "stl-binary"},
    "bodies=0": {"bodies": [], "mesh.bodies": 1},
    "bodies=10000": {"mesh.bodies": 1},
    "defects=100000": {"defects.truncated": False},
    "precision=certified": {"precision": "certified", "properties.volume": 24000},
    "precision=exact": {"precision": "exact", "error_bounds.volume": 0},
    "strict=true": {"checks.solid": True},
    "strict=false": {"checks.solid": True},
    "&&density=2700&": {"properties.mass": 0.0648},
    # options of a later stage take their defaults
    "orient=keep&weld=0&checks=full&precision=auto&resolution=1e-9": {"properties.volume": 24000},
}

NUMBERS = ("", "x", "1x", "0x10", "1e", "--1", "1,2", "nan", "NaN", "inf", "-Infinity", "1e999",
           "1%20", "%2B", "1d3", "%00", "1%00", "\u0661", "1 2")
POSITIVE = NUMBERS + ("0", "-1", "-0", "1e-999")
VECTORS = NUMBERS + ("1", "1,2", "1,2,3,4", "1,2,", ",,", "1,2,nan", "1,2,inf", "1;2;3", "1,,3")
COUNTS = NUMBERS + ("-1", "1.5", "1e2", "99999999999999999999")
BAD = {
    "density": POSITIVE + ("1e400", "1e-400"), "mass": POSITIVE, "about": VECTORS,
    "axis": VECTORS + ("0,0,0", "-0,0,0"), "axis_origin": VECTORS,
    "bodies": COUNTS + ("10001",), "defects": COUNTS + ("100001",),
    "unit": ("", "MM", "inch", "mm ", "km", "1"), "density_unit": ("", "kg", "g/cm", "FILE"),
    "material": ("", "unobtainium", "Steel", "steel%00"), "mass_unit": ("", "kilo", "KG", "t"),
    "format": ("", "STL", "step", "stl-binary"), "flip": ("", "1", "yes", "TRUE", "on"),
    "strict": ("", "0", "no", "True"), "orient": ("", "FIX"), "weld": ("", "-1", "nan"),
    "checks": ("", "none"), "precision": ("", "double"), "resolution": ("", "0", "-1", "nan"),
    "transform": ("", "1,2,3", "nan,0,0,0,0,1,0,0,0,0,1,0"), "include": ("", "facets,", "area"),
    "density[steel]": ("", "0", "x"),
}
LATER = ("precision=exact", "precision=certified", "resolution=1e-6")


def same(got, want):
    number = isinstance(want, float) or (isinstance(want, int) and not isinstance(want, bool))
    if number or (isinstance(want, list) and want and not isinstance(want[0], str)):
        return near(got, want)
    if isinstance(want, dict):
        return isinstance(got, dict) and all(same(got.get(k), w) for k, w in want.items())
    return got == want


def test_good(d):
    def cases():
        for query, wants in GOOD.items():
            a = ask(d.port, post(FILE, query))
            yield query, a.status != 200 and str(a)
            for path, want in wants.items():
                yield query, not same(at(a.json, path), want) and f"{path}: {at(a.json, path)}"

    check_all("options change what they should", cases())
    for query in ("unit=mm", "unit=in"):
        a = d.post(FILE, query=query)
        check(f"{query}: nothing is assumed", warnings(a.json) == set(), a)
    materials = d.get("/v1/capabilities").json["materials"]

    def densities():
        for m in materials[::5]:
            a = d.post(FILE, query="material=" + m["name"])
            yield m["name"], at(a.json, "properties.density") != m["density"]

    check_all("materials have the density that capabilities say", densities())


def test_listed(d):
    two = stl(BOX + box((100, 0, 0), (1, 1, 1)))
    a = d.post(two, query="bodies=1")
    check("bodies limits the list, not the count", len(a.json["bodies"]) == 1
          and a.json["mesh"]["bodies"] == 2 and a.json["properties"]["volume"] == 24001, a)
    for n, truncated in ((0, True), (2, True), (4, False)):
        a = d.post(OPEN, query=f"defects={n}")
        r = a.json
        check(f"defects={n} limits the lists, not the counts", r["checks"]["boundary_edges"] == 4
              and len(r["defects"]["boundary_edges"]) == n
              and r["defects"]["truncated"] is truncated
              and ("defects_truncated" in warnings(r)) is truncated, a)
    a = d.post(OPEN, query="mass=1")
    check("a weighed mass without a volume gives no density", a.status == 200
          and a.json["properties"]["density"] is None and a.json["units"]["mass"] == "kg", a)
    a = d.post(OPEN, query="strict=true")
    check_problem("strict refuses what is no solid", a, 422, "not_a_solid")


def test_bad(d):
    def cases():
        with Wire(d.port) as w:
            for option, value in ((o, v) for o, values in BAD.items() for v in values):
                w.send(post(FILE, quote(option) + "=" + quote(value, safe="%,;")))
                a = w.one()
                yield f"{option}={value!r}", (not a or problem_faults(a, 400, "bad_option",
                                                                      option=option))
                if not a:
                    return

    check_all("values that are none are refused by name", cases())
    for query, option in (("density=1&density=1", "density"), ("unit=mm&unit=mm", "unit"),
                          ("strict=true&density=1&strict=true", "strict"),
                          ("density", "density"), ("density=%zz", "density"),
                          ("density=1%2", "density"), ("density=1&%64ensity=1", "density")):
        a = d.post(FILE, query=query)
        check_problem(f"{query}: refused", a, 400, "bad_option", option=option)
    for query in ("density=1&material=steel", "density=1&mass=1", "material=steel&mass=1",
                  "mass=1&density=1&material=steel"):
        check_problem(f"{query}: exclusive", d.post(FILE, query=query), 400, "bad_option",
                      option=True)


def test_unknown(d):
    for query, option in (("colour=red", "colour"), ("Density=1", "Density"),
                          ("density[]=1", "density[]"), ("density[x=1", "density[x"),
                          ("a%20b=1", "a b"), ("flip=false&x", "x")):
        a = d.post(FILE, query=query)
        check_problem(f"{query}: unknown", a, 400, "unknown_option", option=option)
    long = d.post(FILE, query="x" * 600 + "=1")
    check("a name of 600 bytes", long.status == 400 and len(long.body) < 2000, long)
    check_problem("a query of 20,000 bytes", d.post(FILE, query="density=" + "1" * 20000), 400,
                  "bad_request", limit=True)
    check_problem("no name", d.post(FILE, query="=1"), 400, "bad_request")
    check_problem("a name of control bytes", d.post(FILE, query="%01%7f=1"), 400, "bad_request")
    check_problem("a name that is no UTF-8", d.post(FILE, query="%ff%fe=1"), 400, "bad_request")

    there = d.get("/v1/capabilities").json["options"]

    def cases():
        for query in LATER:
            option = query.partition("=")[0]
            if option in there or option.partition("[")[0] + "[NAME]" in there:
                continue
            a = ask(d.port, post(FILE, quote(query, safe="=,")))
            yield query, problem_faults(a, 400, "option_not_supported", option=option)

    check_all("options of a later stage say so", cases())
    a = d.post(b"no mesh", query="colour=red")
    check("options are judged before the mesh", a.status == 400, a)


def test_same(d, other):
    """Where a chunk ends, and how many workers there are, never matters."""
    meshes = {"box": FILE, "text": stl_ascii(BOX, "a part"), "open": OPEN,
              "torus": stl(torus((1e3, 2e3, -3e3), 10, 3)),
              "bodies": stl(sphere((0, 0, 0), 1) + flip(sphere((0, 0, 0), 0.5)) + BOX),
              "large": stl(sphere((0.1, 0.2, 0.3), 10, 64))}
    query = "density=2700&about=1,2,3&axis=1,2,3&unit=mm"

    def reports():
        for name, data in meshes.items():
            plain = d.post(data, query=query)
            yield name, plain.status != 200 and str(plain)
            for how, a in (("again", d.post(data, query=query)),
                           ("four workers", other.post(data, query=query)),
                           ("by curl in chunks",
                            d.post(data, "-H", "Transfer-Encoding: chunked", query=query))):
                yield f"{name} {how}", differences(untimed(plain.json), untimed(a.json))
            for size in (1, 7, 1000) if len(data) < 5000 else (999, 40000):
                head = (f"POST /v1/mass-properties?{query} HTTP/1.1\r\nHost: x\r\nConnection: close"
                        "\r\nTransfer-Encoding: chunked\r\n\r\n").encode()
                pieces = [data[i:i + size] for i in range(0, len(data), size)]
                text = d.raw(head + chunked(pieces)).partition(b"\r\n\r\n")[2]
                got = untimed(json.loads(text)) if text.startswith(b"{") else {}
                yield f"{name} in chunks of {size}", differences(untimed(plain.json), got)

    check_all("same bytes and options, same report", reports())


with Daemon("--workers", "1") as one, Daemon("--workers", "4") as four:
    test_good(one)
    test_listed(one)
    test_bad(one)
    test_unknown(one)
    test_same(one, four)
finish()
