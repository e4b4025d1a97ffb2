#!/usr/bin/env python3
"""A second opinion: Debian's admesh, a program of 1995 by others, on the same files."""
import shutil

from contract import *
from harness import *

NUMBER = r"([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)"
TURNED = torus((0, 0, 0), 20, 5, 36, 12)
MESHES = {  # admesh takes a file for text unless some byte in the first facets is above 127
    "box": box((0, 0, 0), (40, 30, 20)),
    "wedge": wedge((5, -3, 2), (40, 25, 8)),
    "torus": torus((10, -20, 30), 20, 5, 48, 24),
    "sphere": sphere((1, 2, 3), 10, 40),
    "two bodies": box((0, 0, 0), (10.1, 10, 10)) + sphere((50, 0, 0), 5, 20),
    "cavity": sphere((0, 0, 0), 10, 24) + flip(box((-1, -2, -3), (2, 4, 6))),
    "open box": box((0, 0, 0), (40, 30, 20))[2:],
    "open torus": TURNED[:100] + TURNED[101:300] + TURNED[302:],
}


def second_opinion(path):
    """Its numbers; it computes in single precision and mends what is open."""
    p = subprocess.run(["admesh", path], capture_output=True, timeout=60)
    text = p.stdout.decode("latin-1")

    def number(words, kind=int):
        found = re.search(re.escape(words) + r"\s*[:=]\s*" + NUMBER, text)
        return kind(found.group(1)) if found else None

    out = {"volume": number("Volume", float), "facets": number("Number of facets"),
           "parts": number("Number of parts"), "backwards": number("Backwards edges"),
           "added": number("Facets added"), "reversed": number("Facets reversed"),
           "degenerate": number("Degenerate facets")}
    loose = [number(f"Facets with {n} disconnected edge" + "s" * (n > 1)) for n in (1, 2, 3)]
    out["boundary"] = None if None in loose else loose[0] + 2 * loose[1] + 3 * loose[2]
    out["low"] = [number(f"Min {a}", float) for a in "XYZ"]
    out["high"] = [number(f"Max {a}", float) for a in "XYZ"]
    return out, text


def compare(d, name, mesh, path):
    for kind, data in (("binary", stl(mesh)), ("text", stl_ascii(mesh))):
        with open(path, "wb") as f:
            f.write(data)
        theirs, text = second_opinion(path)
        if not check(f"{name}, {kind}: admesh has an opinion", None not in theirs["low"], text):
            continue
        ours = d.post(data, query="unit=mm").json
        said = f"{theirs}\n{ours['mesh']}\n{ours['checks']}\n{ours['properties']}\n{text}"
        mesh_part, checks = ours["mesh"], ours["checks"]
        check(f"{name}, {kind}: facets and boundary edges",
              theirs["facets"] == mesh_part["triangles"] == len(mesh)
              and theirs["boundary"] == checks["boundary_edges"], said)
        low, high = mesh_part["bounding_box"]["min"], mesh_part["bounding_box"]["max"]
        check(f"{name}, {kind}: box", all(abs(a - b) < 2e-5 for a, b in
                                          zip(theirs["low"] + theirs["high"], low + high)), said)
        check(f"{name}, {kind}: degenerate facets, winding",
              theirs["degenerate"] == checks["degenerate_triangles"]
              and (theirs["backwards"] == 0) == checks["winding_consistent"], said)
        if checks["closed"]:
            check(f"{name}, {kind}: volume and parts", theirs["parts"] == mesh_part["bodies"]
                  and theirs["added"] == 0
                  and near(ours["properties"]["volume"], theirs["volume"], 2e-5), said)
        else:
            check(f"{name}, {kind}: open for both", theirs["boundary"] > 0
                  and ours["properties"]["volume"] is None, said)


if shutil.which("admesh") is None:
    print("ok 1 - a second opinion # SKIP admesh is not installed\n1..1")
    sys.exit(0)
with Daemon("--workers", "1") as daemon, tempfile.TemporaryDirectory() as tmp:
    for title, triangles in MESHES.items():
        compare(daemon, title, triangles, os.path.join(tmp, "mesh.stl"))
finish()
