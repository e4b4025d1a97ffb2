#!/usr/bin/env python3
"""docker/nginx.conf in front of a daemon: reports pass as they are, what libmicrohttpd would answer
by itself never reaches it, and what nginx refuses is a problem in the service's words."""
import re
import shutil

from harness import *
from wire import *

CONF = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docker", "nginx.conf")
NGINX = shutil.which("nginx", path=os.environ.get("PATH", "") + ":/usr/sbin:/usr/local/sbin")
MP = "/v1/mass-properties"
PART = stl(torus((0, 0, 0), 30, 10))


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Nginx:
    """The file as it is, but for the places that it says to change and where it writes."""

    def __init__(self, daemon, rate="50r/s"):
        self.daemon, self.rate, self.port = daemon, rate, free_port()
        self.url = f"http://127.0.0.1:{self.port}"

    def __enter__(self):
        self.folder = tempfile.mkdtemp(prefix="masspropd-nginx-")
        os.chmod(self.folder, 0o777)  # nginx drops root's rights
        with open(CONF, encoding="ascii") as f:
            text = f.read()
        for old, new in (("127.0.0.1:8080", f"127.0.0.1:{self.daemon.port}"),
                         ("listen 8443", f"listen 127.0.0.1:{self.port}"),
                         ("/run/nginx.pid", self.folder + "/pid"), ("/tmp/nginx-", self.folder + "/nginx-"),
                         ("rate=50r/s", f"rate={self.rate}")):
            assert old in text, old
            text = text.replace(old, new)
        path = os.path.join(self.folder, "nginx.conf")
        with open(path, "w", encoding="ascii") as f:
            f.write(text)
        self.process = subprocess.Popen([NGINX, "-p", self.folder, "-c", path, "-g", "daemon off;"],
                                        stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 20
        while curl(self.url + "/livez", timeout=5).status != 200:
            if self.process.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"nginx does not serve (exit {self.process.poll()})")
            time.sleep(0.05)
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(20)
        shutil.rmtree(self.folder, ignore_errors=True)

    def post(self, body, *args, query=""):
        return curl(self.url + MP + query, "-H", "Content-Type: model/stl", *args, body=body)


def head(first, *lines, body=b""):
    lines = [x if isinstance(x, bytes) else x.encode() for x in (first, "Host: x", *lines)]
    return b"\r\n".join(lines) + b"\r\n\r\n" + body


def without_times(report):
    return {k: v for k, v in report.items() if k != "timing_ms"}


def test_reports(d, n):
    plain, a = d.post(PART, query="density=2700"), n.post(PART, query="?density=2700")
    check("a report passes as it is",
          a.status == 200 and without_times(a.json) == without_times(plain.json), a)
    a = n.post(PART, "-H", "Transfer-Encoding: chunked")
    check("chunks pass", a.status == 200, a)
    a = n.post(PART, "-H", "X-Request-Id: order-4711")
    check("the client's id passes", a.headers.get("x-request-id") == "order-4711", a)
    a = n.post(PART, "-H", "X-Request-Id: not { fit")
    check("an id that does not fit is replaced",
          re.fullmatch("[0-9a-f]{32}", a.headers.get("x-request-id", "")), a)
    a = n.post(b"no mesh at all, whatever the reader may think of it" * 5)
    check("a refusal passes as it is", a.status == 422 and a.json["code"] == "unreadable", a)
    large = stl(sphere((0, 0, 0), 50, 200) * 4)
    a = n.post(large, "-H", "Expect: 100-continue")
    check("a large upload, with Expect", a.status == 200, a)
    check("probes pass", curl(n.url + "/readyz").status == 200)
    a = curl(n.url + MP, "-H", "Content-Type: image/png", body=PART)
    check("an early refusal passes", a.status == 415 and "accept-post" in a.headers and
          curl(n.url + "/x").status == 404, a)


SHIELDED = {
    "NUL in a header's value": head("GET /livez HTTP/1.1", b"X-A: a\0b"),
    "NUL in the path": head(b"GET /li\0vez HTTP/1.1"),
    "a path of 100 kB": head("GET /" + "a" * 100000 + " HTTP/1.1"),
    "a query of 100 kB": head("GET /livez?" + "a" * 100000 + " HTTP/1.1"),
    "a header of 100 kB": head("GET /livez HTTP/1.1", "X-A: " + "a" * 100000),
    "1 MB of headers": head("GET /livez HTTP/1.1", *(f"X-{i}: {'a' * 100}" for i in range(10000))),
    "two lengths": head(f"POST {MP} HTTP/1.1", "Content-Length: 5", "Content-Length: 6"),
    "length and chunks": head(f"POST {MP} HTTP/1.1", "Content-Length: 5",
                              "Transfer-Encoding: chunked", body=b"0\r\n\r\n"),
    "chunks that are none": head(f"POST {MP} HTTP/1.1", "Transfer-Encoding: chunked",
                                 body=b"xyz\r\nabc\r\n"),
    "an absurd length": head(f"POST {MP} HTTP/1.1", "Content-Length: 99999999999999999999999"),
    "no host": b"GET /livez HTTP/1.1\r\n\r\n",
    "words": b"what is this thing\r\n\r\n",
    "more than may be sent": head(f"POST {MP} HTTP/1.1", "Content-Length: 2000000000"),
}


def test_shield(d, n):
    for name, data in SHIELDED.items():
        before = d.log()
        with Wire(n.port, 10) as w:
            w.send(data)
            a = w.one()
            ended = a is None and w.ends()
        said = d.log()[len(before):]
        if a is None:
            check(f"{name}: ended without a word", ended, a)
            continue
        fits = False
        if a.headers.get("content-type") == "application/problem+json":
            problem = json.loads(a.body)
            fits = problem["status"] == a.status and problem["code"] in ("bad_request",
                                                                         "body_too_large") \
                and problem["request_id"] == a.headers.get("x-request-id")
        check(f"{name}: a problem in the service's words",
              a.status in (400, 413, 414, 431) and fits, str(a) + said)
        if "chunks" not in name:
            check(f"{name}: never reaches the service", "livez" not in said and MP not in said, said)


def test_limits(d):
    with Nginx(d, rate="1r/s") as n:
        answers = [n.post(PART) for _ in range(110)]
        last = [a for a in answers if a.status == 429]
        check("too many requests of one client: 429 with Retry-After, to be tried again",
              last and last[0].headers.get("retry-after") == "1" and last[0].json["retryable"] and
              last[0].json["code"] == "queue_full", answers[-1])
        check("those before pass", [a.status for a in answers].count(200) >= 100)


def test_metrics_and_absence(d):
    with Nginx(d) as n:
        check("metrics from the inside", curl(n.url + "/metrics").status == 200)
        d.stop()
        a = n.post(PART)
        check("a service that is not there: 502, to be tried again",
              a.status == 502 and a.json["code"] == "worker_lost" and a.json["retryable"], a)


if NGINX is None:
    check("nginx is there", False)
else:
    with Daemon("--workers", "1", "--log-level", "debug") as daemon:
        with Nginx(daemon) as nginx:
            test_reports(daemon, nginx)
            test_shield(daemon, nginx)
        test_limits(daemon)
        test_metrics_and_absence(daemon)
finish()
