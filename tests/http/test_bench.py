"""`make bench` runs: every client, server and other program it needs works, and a table comes out.
No time that it measures is looked at."""
import os
import shutil
import subprocess

from harness import check, finish

build = os.environ.get("BUILD", "build")
rows = ["ASCII", "Draco", "10^6 binary STL", "beside", "one core"]
if os.path.exists(os.path.join(build, "tests/bench/generate")):
    done = subprocess.run(["tests/bench/run", *rows], capture_output=True, text=True,
                          env={**os.environ, "BUILD": build, "BENCH": "smoke"}, timeout=200)
    check("the measuring ends well", done.returncode == 0, done.stdout + done.stderr)
    path = os.path.join(build, "bench-smoke/table.md")
    text = open(path, encoding="utf-8").read() if os.path.exists(path) else ""
    for words in ("10^6 ASCII STL, wall", "Draco, level 0, CPU",
                  "mesh order, CPU", "100 facets beside four uploads", "| decode binary STL |"):
        check(f"the table has a row '{words}'", words in text, text)
    check("no upload was refused", "0 refused" in text, text)
    shutil.rmtree(os.path.join(build, "bench-smoke"), ignore_errors=True)
else:
    check("tests/bench is built", False)
finish()
