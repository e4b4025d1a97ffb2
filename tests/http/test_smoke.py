#!/usr/bin/env python3
"""The shortest way through all layers: is it up, what can it do, what does a box weigh?"""
from harness import *

with Daemon("--workers", "1") as d:
    for path in ("/livez", "/readyz"):
        a = d.get(path)
        check(f"{path} answers 200", a.status == 200, a)
    a = d.get("/v1/capabilities")
    check("capabilities are JSON", a.status == 200 and isinstance(a.json, dict), a)

    a = d.post(stl(box((0, 0, 0), (40, 30, 20))), query="unit=mm&density=2700")
    p = a.json.get("properties", {}) if a.json else {}
    check("a box is answered", a.status == 200 and a.json["schema"] == "masspropd/1", a)
    check("its volume", p.get("volume") == 24000, a)
    check("its centroid", p.get("centroid") == [20, 15, 10], a)
    check("its mass", abs(p.get("mass") - 0.0648) < 1e-15 if p.get("mass") else False, a)
    check("the answer has a request id", a.headers.get("x-request-id"), a)

    a = d.post(b"no mesh at all")
    check("what is no mesh is a problem", a.status == 422, a)
    check("of the right media type",
          a.headers.get("content-type", "").startswith("application/problem+json"), a)
finish()
