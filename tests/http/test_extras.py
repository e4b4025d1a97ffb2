#!/usr/bin/env python3
"""What stands beside the results: the uncertainty of the input."""
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


def main():
    with Daemon() as d:
        test_uncertainty(d)
        test_quantisation(d)
    finish()


main()
