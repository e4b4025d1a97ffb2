#!/usr/bin/env python3
"""What stands beside the results: the uncertainty of the input, facets, digests."""
import gzip
import hashlib
import os
import struct
import tempfile

from contract import *
from draco import encode, obj
from harness import *

RING = torus((5, 0, 0), 30, 8)


def uncertainty(d, data, query="", content_type="model/stl"):
    a = d.post(data, query=query, content_type=content_type)
    return a.json.get("input_uncertainty", "missing") if a.status == 200 else str(a)


def test_uncertainty(d):
    u = uncertainty(d, stl(RING), "density=1&density_unit=g/cm3")
    check("binary STL is float32", u["source"] == "float32", u)
    check("volume, mass and centroid have a deviation",
          0 < u["volume"] < 1 and near(u["mass"], u["volume"] * 1e-6, 1e-15) and
          0 < u["centroid"] < 1e-4, u)
    check("without a density there is none of the mass",
          uncertainty(d, stl(RING))["mass"] is None)
    check("a weighed mass has none", uncertainty(d, stl(RING), "mass=2")["mass"] == 0)
    far = uncertainty(d, stl(torus((1e6, 0, 0), 30, 8)))
    check("far from the origin float32 is coarser", far["volume"] > 1000 * u["volume"], far)
    check("text does not say how many digits count",
          uncertainty(d, stl_ascii(RING)) is None and
          uncertainty(d, obj(RING), content_type="model/obj") is None)
    opened = uncertainty(d, stl(RING[1:]))
    check("an open mesh has a source and no deviations",
          opened == {"source": "float32", "volume": None, "mass": None, "centroid": None}, opened)


def test_quantisation(d):
    coarse, fine = (uncertainty(d, encode(obj(RING), "-qp", bits), content_type="model/x-draco")
                    for bits in ("8", "12"))
    check("Draco is quantised", coarse["source"] == fine["source"] == "quantisation",
          f"{coarse}\n{fine}")
    ratio = coarse["volume"] / fine["volume"]
    check("four bits less are sixteen times the deviation", 14 < ratio < 18, ratio)


def test_facets(d):
    a = d.post(stl(box((0, 0, 0), (40, 30, 20))), query="include=facets")
    f = a.json["facets"]
    check("facets are five columns of as many elements as there are triangles",
          set(f) == {"area", "normal", "centroid", "height", "signed_volume"} and
          all(len(column) == 12 for column in f.values()), a)
    check("their areas and volumes add up", sum(f["area"]) == 5200 and
          near(sum(f["signed_volume"]), 24000), f)
    check("a box has its normals", sorted(map(tuple, f["normal"])) == sorted(
        2 * [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]), f["normal"])
    check("a plane through the origin has height 0, one opposite the size of the box",
          sorted(f["height"]) == 6 * [0] + [20, 20, 30, 30, 40, 40], f["height"])
    turned = d.post(stl(box((0, 0, 0), (40, 30, 20))), query="include=facets&flip=true").json
    check("flip turns normals", turned["facets"]["normal"] ==
          [[-x + 0.0 for x in n] for n in f["normal"]], turned["facets"]["normal"])
    moved = d.post(stl(box((0, 0, 0), (40, 30, 20))),
                   query="include=facets&transform=-1,0,0,5,0,2,0,0,0,0,1,0").json
    f = moved["facets"]
    check("a mirroring transform maps facets and keeps them outward",
          sum(f["area"]) == moved["properties"]["surface_area"] and
          near(sum(f["signed_volume"]), 48000) and
          max(x for x, _, _ in f["centroid"]) == 5, f)
    flat = d.post(stl([((0, 0, 0), (1, 1, 1), (3, 3, 3)), ((0, 0, 1), (1, 0, 1), (0, 1, 1))]),
                  query="include=facets").json["facets"]
    check("a degenerate triangle has no normal, and area 0", flat["normal"] == [None, [0, 0, 1]]
          and flat["height"] == [None, 1] and flat["area"] == [0, 0.5], flat)
    check("facets are null where nobody asked", d.post(stl(RING)).json["facets"] is None)
    many = 500_001
    one = struct.pack("<12fH", 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    a = d.post(bytes(80) + struct.pack("<I", many) + one * many, query="include=facets&defects=0")
    check("too many facets are refused, with the limit", a.status == 413 and
          a.json["code"] == "too_many_triangles" and a.json["option"] == "include" and
          a.json["limit"] == many - 1 and a.json["actual"] == many, a)


def test_digest(d):
    data = stl(RING)
    want = hashlib.sha256(data).hexdigest()
    a = d.post(data, query="include=digest")
    check("the digest is that of the file", a.json["input"]["sha256"] == want and
          "sha256_of_files" not in a.json["input"], a.json["input"])
    a = d.post(gzip.compress(data), "-H", "Content-Encoding: gzip", query="include=digest,facets")
    check("not of how it was packed", a.json["input"]["sha256"] == want, a.json["input"])
    check("it is null where nobody asked", d.post(data).json["input"]["sha256"] is None)
    other = stl(torus((500, 0, 0), 30, 8))
    with tempfile.TemporaryDirectory() as tmp:
        for name, content in (("a.stl", data), ("b.stl", other)):
            with open(os.path.join(tmp, name), "wb") as f:
                f.write(content)
        files = [x for n in ("a.stl", "b.stl") for x in ("-F", f"file=@{os.path.join(tmp, n)}")]
        a = d.curl("/v1/mass-properties", "-F", "include=digest", *files)
        check("of several files the first, and a list of all",
              a.json["input"]["sha256"] == want and
              a.json["input"]["sha256_of_files"] == [want, hashlib.sha256(other).hexdigest()], a)
        a = d.curl("/v1/mass-properties", *files, "-F", "include=digest")
        check("behind the files it is too late", a.status == 400 and
              a.json["code"] == "bad_option" and a.json["option"] == "include", a)
        a = d.curl("/v1/mass-properties", *files, "-F", "include=facets")
        check("for facets it is not", a.status == 200 and
              len(a.json["facets"]["area"]) == a.json["mesh"]["triangles"], a.status)


def main():
    with Daemon() as d:
        test_uncertainty(d)
        test_quantisation(d)
        test_facets(d)
        test_digest(d)
    finish()


main()
