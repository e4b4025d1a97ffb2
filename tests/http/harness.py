"""What the HTTP tests share: a daemon of their own, curl, raw sockets, TAP, and meshes.

    from harness import *
    with Daemon("--workers", "1") as d:
        a = d.post(stl(box((0, 0, 0), (40, 30, 20))), query="density=2700")
        check("volume of a box", a.status == 200 and a.json["properties"]["volume"] == 24000, a)
    finish()

Run by tests/run, or by hand: MASSPROPD=build/masspropd python3 tests/http/test_smoke.py
Tests run beside each other; one that measures times or fills the machine says so with a line
"# tests/run: alone".
"""
import json
import math
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

import schema

PROGRAM = os.environ.get("MASSPROPD", "build/masspropd")
# Built with the address sanitizer: memory limits are off, and what is freed stays with the process.
try:
    with open(PROGRAM, "rb") as _f:
        SANITIZED = b"__asan_init" in _f.read()
except OSError:  # not built: for the fuzz targets' seeds only the meshes are wanted
    SANITIZED = False

# ---------------------------------------------------------------------------------------- TAP

_results = []
_contract = {"answers": 0, "faults": []}


def check(name, condition, detail=""):
    """One test.  ${detail} is shown where it failed; returns whether it passed."""
    good = bool(condition)
    _results.append(good)
    print(f"{'ok' if good else 'not ok'} {len(_results)} - {name}")
    if not good and detail != "":
        for line in str(detail)[:4000].splitlines():
            print(f"# {line}")
    sys.stdout.flush()
    return good


def finish():
    """The last call of every test file: without the plan the file counts as crashed."""
    if _contract["answers"] > 0:
        if schema.Draft202012Validator is None:
            check("python3-jsonschema is there", False)
        check("every JSON answer is as api/openapi.json says", not _contract["faults"],
              "\n".join(_contract["faults"][:20]))
    print(f"1..{len(_results)}", flush=True)
    sys.exit(0 if _results and all(_results) else 1)


# --------------------------------------------------------------------------------------- curl


class Answer:
    """status (0: no answer), headers (names in lower case, repeated ones joined by ", "), body,
    json (None where the body is none), interim (statuses before the last, e.g. [100]) and curl's
    own exit code and words."""

    def __init__(self, head, body, curl_exit, curl_error):
        blocks = [b for b in re.split(r"\r?\n\r?\n", head) if b.startswith("HTTP/")]
        statuses = [int(b.split(None, 2)[1]) for b in blocks]
        self.status, self.interim = (statuses[-1], statuses[:-1]) if statuses else (0, [])
        self.headers = {}
        for line in blocks[-1].splitlines()[1:] if blocks else []:
            name, _, value = line.partition(":")
            name, value = name.strip().lower(), value.strip()
            seen = self.headers.get(name)
            self.headers[name] = value if seen is None else seen + ", " + value
        self.body, self.curl_exit, self.curl_error = body, curl_exit, curl_error
        try:
            self.json = json.loads(body)
        except ValueError:
            self.json = None

    def __str__(self):
        text = self.body[:600].decode("utf-8", "replace")
        return f"{self.status} {self.headers} curl {self.curl_exit} {self.curl_error}\n{text}"


def curl(url, *args, body=None, timeout=60):
    """One call of the real curl.  ${body}: bytes to send (POST), ${args}: further arguments."""
    with tempfile.TemporaryDirectory() as tmp:
        out, head = os.path.join(tmp, "body"), os.path.join(tmp, "head")
        command = ["curl", "-sS", "--max-time", str(timeout), "-g", "-o", out, "-D", head]
        if body is not None:
            command += ["--data-binary", "@-"]
        done = subprocess.run(command + [*args, url], input=body or b"", capture_output=True,
                              timeout=timeout + 10)

        def read(path):
            return open(path, "rb").read() if os.path.exists(path) else b""

        return Answer(read(head).decode("latin-1"), read(out), done.returncode,
                      done.stderr.decode("utf-8", "replace").strip())


# ------------------------------------------------------------------------------------- daemon

SANITIZER = re.compile(r"ERROR: \w*Sanitizer|runtime error:|SUMMARY: \w*Sanitizer")


class Daemon:
    """masspropd on a free port of the loopback, in a with statement.

    On leaving it is told to stop and must exit with ${expect_exit} (None: do not check), and no
    sanitizer may have spoken.  d.url, d.port, d.pid; d.log() is what it wrote to stderr so far.
    """

    def __init__(self, *flags, env=None, listen="127.0.0.1:0", expect_exit=0, ready=True):
        self.flags, self.listen, self.expect_exit, self.ready = flags, listen, expect_exit, ready
        self.env = {**os.environ, **(env or {})}

    def __enter__(self):
        self._log = tempfile.NamedTemporaryFile(prefix="masspropd-", suffix=".log")
        command = [PROGRAM, "--listen", self.listen, *self.flags]
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                        stderr=self._log, env=self.env)
        self.pid = self.process.pid
        self.url = self.process.stdout.readline().decode().strip()
        found = re.fullmatch(r"http://(.+):(\d+)/?", self.url)
        if not found:
            self.process.kill()
            self.process.wait()
            raise RuntimeError(f"{command}: first line {self.url!r}, stderr: {self.log()}")
        self.url, self.port = self.url.rstrip("/"), int(found.group(2))
        if self.ready:
            self.wait_ready()
        return self

    def wait_ready(self, seconds=20):
        end = time.monotonic() + seconds
        while self.get("/readyz", timeout=5).status != 200:
            if self.process.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"not ready (exit {self.process.poll()}): {self.log()}")
            time.sleep(0.05)

    def __exit__(self, kind, _value, _trace):
        code = self.stop()
        log = self.log()
        if self.expect_exit is not None and kind is None:
            check("the daemon stops when told to", code == self.expect_exit, f"exit {code}\n{log}")
        if SANITIZER.search(log):
            check("no sanitizer speaks", False, log)
        self.process.stdout.close()
        self._log.close()

    def log(self):
        with open(self._log.name, "rb") as f:
            return f.read().decode("utf-8", "replace")

    def stop(self, sig=signal.SIGTERM, timeout=40):
        """Send ${sig} and wait; the exit code, negative for a signal."""
        if self.process.poll() is None:
            self.process.send_signal(sig)
        try:
            return self.process.wait(timeout)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            return "killed: it did not stop"

    def curl(self, path, *args, body=None, timeout=60):
        answer = curl(self.url + path, *args, body=body, timeout=timeout)
        if answer.json is not None:
            _contract["answers"] += 1
            _contract["faults"] += schema.faults(path, answer)
        return answer

    def get(self, path, *args, timeout=60):
        return self.curl(path, *args, timeout=timeout)

    def post(self, body, *args, query="", path="/v1/mass-properties", content_type="model/stl",
             timeout=60):
        """Post a mesh; ${query} without the question mark; content_type None: none at all."""
        kind = "Content-Type:" + (" " + content_type if content_type else "")
        return self.curl(path + ("?" + query if query else ""), "-H", kind, *args, body=body,
                         timeout=timeout)

    def raw(self, data, timeout=10, half_close=False):
        """Send bytes as they are over a socket and return all that comes back until the peer
        closes or ${timeout} seconds pass in silence."""
        with self.connect(timeout) as s:
            s.sendall(data)
            if half_close:
                s.shutdown(socket.SHUT_WR)
            return receive(s)

    def connect(self, timeout=10):
        """A connected socket, for tests that send by and by."""
        return socket.create_connection(("127.0.0.1", self.port), timeout)


def receive(s):
    """All bytes until the peer closes, resets or falls silent for the socket's timeout."""
    got = b""
    try:
        while chunk := s.recv(65536):
            got += chunk
    except (socket.timeout, ConnectionResetError):
        pass
    return got


# ------------------------------------------------------------------------------------- meshes
# A mesh is a list of triangles ((x, y, z), (x, y, z), (x, y, z)), wound outward.


def box(low, size):
    """12 triangles."""
    p = [tuple(low[a] + size[a] * (i >> a & 1) for a in range(3)) for i in range(8)]
    faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    return [t for a, b, c, d in faces for t in ((p[a], p[b], p[c]), (p[a], p[c], p[d]))]


def wedge(low, size):
    """8 triangles: the half of a box below the plane x/sx + y/sy = 1; volume sx*sy*sz/2."""
    (x, y, z), (a, b, c) = low, size
    p = [(x, y, z), (x + a, y, z), (x, y + b, z), (x, y, z + c), (x + a, y, z + c),
         (x, y + b, z + c)]
    index = ((0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (0, 3, 5), (0, 5, 2), (1, 2, 5), (1, 5, 4))
    return [tuple(p[i] for i in t) for t in index]


def grid(point, n, m, wrap_m):
    """Triangles of a surface closed in u (n steps) and, if ${wrap_m}, in v (m steps)."""
    rows = [[point(i, j) for i in range(n)] for j in range(m if wrap_m else m + 1)]
    out = []
    for j in range(m):
        low, high = rows[j], rows[(j + 1) % len(rows)]
        for i in range(n):
            k = (i + 1) % n
            out += [t for t in ((low[i], low[k], high[k]), (low[i], high[k], high[i]))
                    if len(set(t)) == 3]
    return out


def sphere(centre, radius, n=24):
    """2n(n-1) triangles between n meridians and n parallels, poles on the z axis."""

    def point(i, j):
        u, v = 2 * math.pi * i / n, math.pi * j / n
        r = 0 if j in (0, n) else radius * math.sin(v)
        return (centre[0] + r * math.cos(u), centre[1] + r * math.sin(u),
                centre[2] - radius * math.cos(v))

    return grid(point, n, n, False)


def torus(centre, radius, tube, n=24, m=12):
    """2nm triangles about the z axis through ${centre}."""

    def point(i, j):
        u, v = 2 * math.pi * i / n, 2 * math.pi * j / m
        r = radius + tube * math.cos(v)
        return (centre[0] + r * math.cos(u), centre[1] + r * math.sin(u),
                centre[2] + tube * math.sin(v))

    return grid(point, n, m, True)


def flip(mesh):
    """The same mesh inside out."""
    return [(a, c, b) for a, b, c in mesh]


def stl(mesh, header=b"binary STL by a test"):
    """Binary STL with zero normals."""
    facets = b"".join(struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0) for a, b, c in mesh)
    return header.ljust(80, b"\0")[:80] + struct.pack("<I", len(mesh)) + facets


def stl_ascii(mesh, name="part", newline="\n"):
    """ASCII STL that reads back to the same doubles."""
    lines = [f"solid {name}"]
    for t in mesh:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(repr(float(x)) for x in p) for p in t]
        lines += ["endloop", "endfacet"]
    return (newline.join(lines + [f"endsolid {name}"]) + newline).encode()


def volume(mesh):
    """For comparison; summed about the first vertex."""
    o = mesh[0][0]
    total = 0.0
    for t in mesh:
        a, b, c = ([p[i] - o[i] for i in range(3)] for p in t)
        total += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                  + a[2] * (b[0] * c[1] - b[1] * c[0]))
    return total / 6
