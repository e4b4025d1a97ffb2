#!/usr/bin/env python3
"""Every endpoint by every method, and the headers that every answer has."""
import json

from contract import *
from harness import *
from wire import *

MP = "/v1/mass-properties"
BOX = stl(box((0, 0, 0), (40, 30, 20)))
READ = ("/livez", "/readyz", "/v1/capabilities")
CORS = ("--cors-origin", "https://app.example.com,*.parts.test", "--cors-origin",
        "http://localhost:3000")


def test_methods(d):
    def cases():
        for path in READ:
            got = ask(d.port, request("GET", path))
            head = ask(d.port, request("HEAD", path), head=True)
            yield f"GET {path}", got.status != 200 or common_faults(got)
            same = head.headers.get("content-length") == got.headers["content-length"]
            yield f"HEAD {path}", head.status != 200 or not same or common_faults(head)
            a = d.curl(path, "-X", "OPTIONS")
            right = a.status == 204 and a.headers.get("allow") == "GET, HEAD, OPTIONS"
            yield f"OPTIONS {path}", not right or common_faults(a)
            for method in ("POST", "PUT", "DELETE", "PATCH", "TRACE", "get", "FROBNICATE"):
                a = d.curl(path, "-X", method)
                yield f"{method} {path}", (problem_faults(a, 405, "method_not_allowed",
                                                          instance=path)
                                           or a.headers.get("allow") != "GET, HEAD, OPTIONS")

    check_all("what is read answers GET, HEAD and OPTIONS and nothing else", cases())


def test_post_only(d):
    def cases():
        for method in ("GET", "PUT", "DELETE", "PATCH", "post"):
            a = d.curl(MP, "-X", method)
            yield method, (problem_faults(a, 405, "method_not_allowed")
                           or a.headers.get("allow") != "POST, OPTIONS")
        a = ask(d.port, request("HEAD", MP), head=True)
        yield "HEAD", a.status != 405 or a.headers.get("allow") != "POST, OPTIONS"
        a = d.curl(MP, "-X", "OPTIONS")
        yield "OPTIONS", a.status != 204 or a.headers.get("allow") != "POST, OPTIONS"
        a = d.post(BOX)
        yield "POST", a.status != 200 or common_faults(a)

    check_all("mass-properties answers POST and OPTIONS and nothing else", cases())
    check("a HEAD on it leaves the connection in order", heads_are_bodyless(d))


def heads_are_bodyless(d):
    with Wire(d.port) as w:
        for path in (MP, *READ, "/nothing"):
            w.send(request("HEAD", path))
            if w.one(head=True) is None:
                return False
        w.send(request("GET", "/livez"))
        last = w.one()
        return last is not None and last.body == b"alive\n"


def test_nowhere(d):
    paths = ("/", "/nothing", "/v1", "/v1/", "/v1/mass-properties/", "/livez/", "//livez",
             "/LIVEZ", "/livez%00", "/../livez", "/v1/mesh%2f", "/%ff%fe", "/.env")

    def cases():
        for path in paths:
            for method in ("GET", "POST", "OPTIONS"):
                a = d.curl(path, "-X", method, "--path-as-is")
                yield f"{method} {path}", problem_faults(a, 404, "not_found", instance=path)

    check_all("other paths are not found", cases())
    a = ask(d.port, b"GET /\xff\xfe\xc3\x28 HTTP/1.1\r\nHost: x\r\n\r\n")
    check("a path that is not UTF-8 does not spoil the JSON", a and a.status in (400, 404)
          and (a.json is not None or not a.body) and a.body.decode("utf-8") is not None, a)


def test_probes(d):
    a = d.get("/livez")
    check("livez is a word", a.body == b"alive\n" and "text/plain" in a.headers["content-type"], a)
    a = d.get("/readyz")
    check("readyz is a word", a.status == 200 and a.body == b"ready\n", a)
    a = d.get("/readyz?verbose")
    check("readyz?verbose counts workers", a.status == 200 and b"workers: 2 of 2" in a.body, a)
    check("probes are not cached", a.headers.get("cache-control") == "no-store", a)


def test_capabilities(d):
    a = d.get("/v1/capabilities")
    c = a.json or {}
    check("capabilities are JSON", a.headers.get("content-type") == "application/json", a)
    names = {m["name"] for m in c.get("materials", [])}
    check("they list formats, units, materials and options",
          "stl-binary" in c.get("formats", []) and "mm" in c.get("units", [])
          and "model/stl" in c.get("media_types", []) and "steel" in names
          and "density" in c.get("options", []) and "transform" in c.get("options", []), a)
    check("they give the limits in force", at(c, "limits.max_triangles") == 5000
          and at(c, "limits.max_body") == 2000000 and at(c, "limits.deadline_s") == 30
          and at(c, "limits.workers") == 1, a)
    version = subprocess.run([PROGRAM, "--version"], capture_output=True, timeout=10).stdout
    check("they name the version", f"masspropd {c.get('version')}\n".encode() == version, a)

    def cases():
        for kind in c.get("media_types", ["none"]):
            if kind.startswith("multipart/"):
                continue
            a = d.post(BOX, content_type=kind)
            yield kind, a.status != 200 and str(a)
            a = d.post(BOX, content_type=kind.upper() + " ; charset=x")
            yield kind.upper(), a.status != 200 and str(a)
        yield "none", d.post(BOX, content_type=None).status != 200

    check_all("every media type that they list is taken", cases())


def test_accept(d):
    def cases():
        for accept in ("*/*", "application/json", "text/html, application/*;q=0.5", None):
            a = d.post(BOX, "-H", "Accept:" + (" " + accept if accept else ""))
            yield accept, a.status != 200
        for accept in ("text/html", "application/xml, image/*", "application/json;q=0"):
            a = d.post(BOX, "-H", "Accept: " + accept)
            yield accept, problem_faults(a, 406, "not_acceptable")

    check_all("who does not take JSON is told so", cases())


def test_request_id(d):
    def cases():
        for wish in ("a", "abc.DEF_1-2", "x" * 64):
            a = d.get("/nothing", "-H", "X-Request-Id: " + wish)
            yield wish, (a.headers.get("x-request-id") != wish
                         or a.json["request_id"] != wish)
        for wish in ("x" * 65, "a b", "a/b", "a,b", "\u00e9", '"', "<script>"):
            a = d.post(b"x", "-H", "X-Request-Id: " + wish)
            given = a.headers.get("x-request-id", "")
            yield wish, given == wish or not REQUEST_ID.fullmatch(given)
        a = d.get("/livez", "-H", "X-Request-Id;")
        yield "empty", common_faults(a)

    check_all("a client's request id is kept where it is harmless", cases())
    a = d.post(BOX, "-H", "X-Request-Id: part-7")
    check("with a report too", a.headers.get("x-request-id") == "part-7", a)
    ids = {d.get("/livez").headers["x-request-id"] for _ in range(5)}
    check("ids of our own differ", len(ids) == 5, ids)


def allowed(a, origin):
    exposed = a.headers.get("access-control-expose-headers", "").lower()
    return (a.headers.get("access-control-allow-origin") == origin
            and all(h in exposed for h in ("x-request-id", "server-timing", "retry-after"))
            and "access-control-allow-credentials" not in a.headers)


def test_origins(d):
    def cases():
        for origin in ("https://app.example.com", "https://a.parts.test", "http://b.a.parts.test",
                       "http://localhost:3000"):
            yield origin, not allowed(d.get("/livez", "-H", "Origin: " + origin), origin)
        for origin in ("https://app.example.com.evil.test", "http://app.example.com", "null",
                       "https://evilparts.test", "https://parts.test", "*", "x" * 3000):
            a = d.get("/livez", "-H", "Origin: " + origin)
            yield origin[:50], (a.status != 200 or common_faults(a)
                                or any(h.startswith("access-control") for h in a.headers))

    check_all("origins are allowed as configured", cases())
    origin = "https://a.parts.test"
    answers = [d.post(BOX, "-H", "Origin: " + origin), d.post(b"x", "-H", "Origin: " + origin),
               d.post(BOX, "-H", "Origin: " + origin, query="density=x"),
               d.get("/nothing", "-H", "Origin: " + origin)]
    check("reports and errors can be read across origins",
          [a.status for a in answers] == [200, 422, 400, 404]
          and all(allowed(a, origin) for a in answers), *answers[:1])


def preflight(d, origin, path=MP, *more):
    return d.curl(path, "-X", "OPTIONS", "-H", "Origin: " + origin, "-H",
                  "Access-Control-Request-Method: POST", *more)


def test_preflight(d):
    origin = "https://app.example.com"
    a = preflight(d, origin, MP, "-H", "Access-Control-Request-Headers: content-type, x-request-id",
                  "-H", "Accept: text/html")
    methods = a.headers.get("access-control-allow-methods", "")
    names = a.headers.get("access-control-allow-headers", "").lower()
    check("a preflight is answered", a.status == 204 and not a.body and not common_faults(a)
          and a.headers.get("access-control-allow-origin") == origin, a)
    check("it allows POST and the headers that clients need", "POST" in methods
          and all(n in names for n in ("content-type", "x-request-id", "authorization")), a)
    check("it may be kept for a while", int(a.headers.get("access-control-max-age", 0)) > 0, a)
    check("private networks are not mentioned unasked",
          "access-control-allow-private-network" not in a.headers, a)
    a = preflight(d, origin, MP, "-H", "Access-Control-Request-Private-Network: true")
    check("private networks are allowed to an allowed origin",
          a.headers.get("access-control-allow-private-network") == "true", a)
    a = preflight(d, "https://evil.test", MP, "-H", "Access-Control-Request-Private-Network: true")
    check("another origin is allowed nothing", a.status == 204
          and not any(h.startswith("access-control") for h in a.headers), a)
    a = preflight(d, origin, "/v1/capabilities")
    check("a preflight knows what its path allows",
          a.headers.get("access-control-allow-methods") == "GET, HEAD, OPTIONS", a)
    a = d.curl(MP + "?nonsense=1&density=", "-X", "OPTIONS", "-H", "Origin: " + origin, "-H",
               "Access-Control-Request-Method: POST", "-H", "Content-Type: image/png")
    check("a preflight comes before any check of options and types", a.status == 204, a)


with Daemon("--workers", "1", "--max-triangles", "5k", "--max-body", "2MB") as plain:
    test_methods(plain)
    test_post_only(plain)
    test_nowhere(plain)
    test_probes(plain)
    test_capabilities(plain)
    test_accept(plain)
    test_request_id(plain)
    a = plain.get("/livez", "-H", "Origin: https://app.example.com")
    check("no origin is allowed unless one is configured",
          not any(h.startswith("access-control") for h in a.headers), a)
with Daemon("--workers", "1", *CORS) as open_to_some:
    test_origins(open_to_some)
    test_preflight(open_to_some)
finish()
