#!/usr/bin/env python3
"""Requests that nobody sends by mistake: never a hang, never a 500, never two meanings."""
from contract import *
from family import *
from harness import *
from wire import *

FILE = stl(box((0, 0, 0), (40, 30, 20)))
N = len(FILE)
MP = "/v1/mass-properties"
PATIENCE = 4  # seconds of silence that count as a hang


def raw(first, *headers, body=b"", host=True):
    """A request as it is; headers: str or bytes."""
    lines = [first, "Host: x"] if host else [first]
    lines = [x if isinstance(x, bytes) else x.encode("latin-1") for x in (*lines, *headers)]
    return b"\r\n".join(lines) + b"\r\n\r\n" + body


def send(d, data, head=False):
    """(answer or None, has the connection ended, was there more than one answer)."""
    with Wire(d.port, PATIENCE) as w:
        w.send(data)
        a = w.one(head)
        w.socket.settimeout(0.2)
        ended = w.ends()
        return a, ended, len(replies(w.data[w.used:])) > 0


def judge(d, data, wanted, head=False, must_end=True):
    """What is wrong with how the daemon takes ${data}; ${wanted}: statuses, None: just an end."""
    a, ended, more = send(d, data, head)
    faults = []
    if a is None and not (None in wanted and ended):
        faults.append("silence" if not ended else "ended without a word")
    if a is not None and a.status not in wanted:
        faults.append(f"{a}")
    if a is not None and must_end and not ended:
        faults.append(f"the connection goes on after {a.status}")
    if more:
        faults.append("a second answer")
    if ask(d.port, request(), PATIENCE) is None:
        faults.append("the daemon does not answer any more")
    return faults


def cases_of(d, table, wanted, **how):
    for name, data in table.items():
        yield name, judge(d, data, wanted, **how)


POST = f"POST {MP} HTTP/1.1"
LENGTH = f"Content-Length: {N}"
CHUNKED = "Transfer-Encoding: chunked"
SMUGGLED = request(path="/livez")
CHUNKS = chunked([FILE])

FRAMING = {  # two readings of where the body ends: refused, and nothing behind it is a request
    "two lengths": raw(POST, LENGTH, "Content-Length: 5", body=FILE + SMUGGLED),
    "two equal lengths": raw(POST, LENGTH, LENGTH, body=FILE + SMUGGLED),
    "a list of lengths": raw(POST, f"Content-Length: {N}, {N}", body=FILE + SMUGGLED),
    "length and chunks": raw(POST, LENGTH, CHUNKED, body=CHUNKS + SMUGGLED),
    "chunks and length": raw(POST, CHUNKED, "Content-Length: 4", body=CHUNKS + SMUGGLED),
    "chunks twice": raw(POST, CHUNKED, CHUNKED, body=CHUNKS + SMUGGLED),
    "gzip": raw(POST, "Transfer-Encoding: gzip", body=CHUNKS + SMUGGLED),
    "gzip, chunked": raw(POST, "Transfer-Encoding: gzip, chunked", body=CHUNKS + SMUGGLED),
    "identity": raw(POST, "Transfer-Encoding: identity", LENGTH, body=FILE + SMUGGLED),
    "xchunked": raw(POST, "Transfer-Encoding: xchunked", body=CHUNKS + SMUGGLED),
    "chunked in quotes": raw(POST, 'Transfer-Encoding: "chunked"', body=CHUNKS + SMUGGLED),
    "a tab before it": raw(POST, "Transfer-Encoding:\tchunked", LENGTH, body=CHUNKS + SMUGGLED),
    "a blank before the colon": raw(POST, f"Content-Length : {N}", body=FILE + SMUGGLED),
    "a blank before that colon": raw(POST, "Transfer-Encoding : chunked", body=CHUNKS + SMUGGLED),
    "a folded length": raw(POST, "Content-Length: 1", " 0", body=FILE + SMUGGLED),
    "chunked on the next line": raw(POST, "Transfer-Encoding:", " chunked", "Content-Length: 5",
                                    body=CHUNKS + SMUGGLED),
    "chunked on two lines": raw(POST, "Transfer-Encoding: chun", "\tked", "Content-Length: 5",
                                body=CHUNKS + SMUGGLED),
    "a vertical tab": raw(POST, "Transfer-Encoding: \x0bchunked", body=CHUNKS + SMUGGLED),
    "GET with both": raw("GET /livez HTTP/1.1", "Content-Length: 5", CHUNKED, body=CHUNKS),
}
LENGTHS = {n: raw(POST, "Content-Length: " + n, body=FILE + SMUGGLED) for n in (
    "-1", "+684", "0x2ac", "6 84", "684;", "1e3", "", "684.0", "99999999999999999999999999",
    "18446744073709551616", "18446744073709551615", "9223372036854775808", "a", "\xb2")}
BYTES = {
    "NUL in a name": raw("GET /livez HTTP/1.1", b"X\0A: b"),
    "SOH in a value": raw("GET /livez HTTP/1.1", b"X-A: a\x01b"),
    "DEL in a value": raw("GET /livez HTTP/1.1", b"X-A: a\x7fb"),
    "CR in a value": raw("GET /livez HTTP/1.1", b"X-A: a\rX-B: b"),
    "a blank in a name": raw("GET /livez HTTP/1.1", b"X A: b"),
    "no colon": raw("GET /livez HTTP/1.1", b"nonsense"),
    "a name in brackets": raw("GET /livez HTTP/1.1", b"X(A): value"),
    "a name in Latin-1": raw("GET /livez HTTP/1.1", b"caf\xe9: value"),
    "a first line that is folded": raw("GET /livez HTTP/1.1", " X: y", host=False),
}
LINES = {
    "words": b"what is this\r\n\r\n", "one word": b"GET\r\n\r\n",
    "TLS": b"\x16\x03\x01\x02\x00\x01",
    "NUL in the path": raw(b"GET /li\0vez HTTP/1.1"), "no version": b"GET /livez\r\n\r\n",
    "HTTP/2": b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", "HTTP/9": raw("GET /livez HTTP/9.9"),
    "http": raw("GET /livez http/1.1"), "HTTP/1.1x": raw("GET /livez HTTP/1.1x"),
    "blanks": raw("GET  /livez  HTTP/1.1"), "a tab": raw("GET\t/livez\tHTTP/1.1"),
    "a path of blanks": raw("GET /li vez HTTP/1.1"), "empty lines": b"\r\n" * 50 + b"\r\n",
    "an empty method": b" /livez HTTP/1.1\r\nHost: x\r\n\r\n",
}
CHUNKING = {name: raw(POST, CHUNKED, body=body) for name, body in {
    "no number": b"xyz\r\nabc\r\n0\r\n\r\n", "a minus": b"-5\r\nabcde\r\n0\r\n\r\n",
    "0x5": b"0x5\r\nabcde\r\n0\r\n\r\n", "too many digits": b"f" * 20 + b"\r\nabc",
    "2^64 - 1": b"ffffffffffffffff\r\nabc", "2^64": b"10000000000000000\r\nabc\r\n0\r\n\r\n",
    "no end of a chunk": b"5\r\nabcdeX5\r\n", "a blank number": b"\r\n\r\n",
    "an endless extension": b"5;" + b"a" * 200000 + b"\r\nabcde\r\n0\r\n\r\n",
    "an endless number": b"0" * 200000, "endless trailers": b"0\r\n" + b"X: y\r\n" * 50000,
}.items()}
LARGE = {
    "a path of 100 kB": raw("GET /" + "a" * 100000 + " HTTP/1.1"),
    "a path of 1 MB": raw("GET /" + "a" * 1000000 + " HTTP/1.1"),
    "a query of 100 kB": raw("GET /livez?" + "a" * 100000 + " HTTP/1.1"),
    "a header of 1 MB": raw("GET /livez HTTP/1.1", "X-A: " + "a" * 1000000),
    "a name of 1 MB": raw("GET /livez HTTP/1.1", "a" * 1000000 + ": b"),
    "20,000 headers": raw("GET /livez HTTP/1.1", *(f"X-{i}: {i}" for i in range(20000))),
    "a method of 1 MB": raw("G" * 1000000 + " /livez HTTP/1.1"),
}


def test_tables(d):
    check_all("a body with two ends is refused, and the connection with it",
              cases_of(d, FRAMING, (400, None)))
    # libmicrohttpd 1.0 unfolds it and knows where the body ends, 0.9.75 does not
    check_all("a length on the next line is refused, or taken for what it is",
              cases_of(d, {"alone": raw(POST, "Content-Length:", f" {N}", body=FILE)},
                       (200,) if LIBRARY >= 1 else (400, None), must_end=LIBRARY < 1))
    check_all("absurd lengths are refused", cases_of(d, LENGTHS, (400, 413, None)))
    check_all("control bytes in headers are refused", cases_of(d, BYTES, (400, None)))
    redirects = (301,) if LIBRARY >= 1 else ()  # of targets with blanks
    check_all("what is no request line",
              cases_of(d, LINES, (200, 400, 404, 405, 505, None) + redirects, must_end=False))
    check_all("chunks that are none", cases_of(d, CHUNKING, (400, 408, 413, 422, 431, None)))
    check_all("heads beyond all bounds", cases_of(d, LARGE, (200, 400, 404, 413, 414, 431, None),
                                                  must_end=False))
    check("the front has lived through it all", "the front ended" not in d.log()
          and "replacing" not in d.log(), d.log()[-2000:])


def test_hosts(d):
    def cases():
        yield "none", judge(d, raw("GET /livez HTTP/1.1", host=False), (400,))
        yield "two", judge(d, raw("GET /livez HTTP/1.1", "Host: y"), (400,))
        for name in ("", "x:80", "[::1]:8080", "evil.example"):
            data = raw("GET /livez HTTP/1.1", "Host: " + name, host=False)
            yield repr(name), judge(d, data, (200,), must_end=False)

    check_all("HTTP/1.1 has exactly one Host", cases())


def test_old_and_odd_forms(d):
    a, ended, _ = send(d, raw("GET /livez HTTP/1.0", host=False))
    check("HTTP/1.0 needs no Host and ends", a and a.status == 200 and ended, a)
    a, ended, _ = send(d, raw(f"POST {MP} HTTP/1.0", LENGTH, body=FILE, host=False))
    check("HTTP/1.0 may post", a and a.status == 200 and ended, a)
    with Wire(d.port, PATIENCE) as w:
        for _ in range(2):
            w.send(raw("GET /livez HTTP/1.0", "Connection: keep-alive", host=False))
            a = w.one()
        check("HTTP/1.0 may ask to go on", a and a.status == 200, a)
    for form, status in ((f"http://x{MP}", 200), (f"http://other:99{MP}?density=1", 200),
                         (f"HTTP://x{MP}", 200), (f"https://x{MP}", 200), ("http://", 404),
                         ("http://x", 404), ("http://x?density=1", 404), ("https://", 404),
                         ("//", 404)):
        a, _, _ = send(d, raw(f"POST {form} HTTP/1.1", LENGTH, body=FILE))
        check(f"the absolute form {form}", a and a.status == status, a)
    a, _, _ = send(d, raw("OPTIONS * HTTP/1.1"))
    check("OPTIONS *", a and a.status == 204 and "POST" in a.headers.get("allow", ""), a)
    a, _, _ = send(d, raw("CONNECT x:80 HTTP/1.1"))
    check("CONNECT", a and a.status in (400, 404, 405, 501), a)
    with Wire(d.port, PATIENCE) as w:
        for method, path, body, status in (("GET", "/livez", FILE, 200), ("GET", MP, FILE, 405),
                                           ("DELETE", "/livez", FILE, 405),
                                           ("OPTIONS", MP, FILE, 204), ("POST", "/x", FILE, 404)):
            w.send(request(method, path, body=body))
            a = w.one()
            check(f"{method} {path} with a body: answered, the body passed over",
                  a and a.status == status, a)
    a, _, _ = send(d, raw("GET /livez HTTP/1.1", "Connection: close"))
    check("Connection: close is obeyed", a and a.headers.get("connection") == "close", a)
    a, _, _ = send(d, raw("GET /livez HTTP/1.1", "Upgrade: h2c", "Connection: Upgrade",
                          "X-A: caf\xe9", "Cookie: a=b; c", "Accept: \xff"))
    check("headers of no concern", a and a.status == 200, a)
    a, _, _ = send(d, raw(POST, "transfer-ENCODING: ChunKed",
                          body=b"2aC\r\n" + FILE + b"\r\n000\r\nTrailer: x\r\n\r\n"))
    check("chunks, trailers, letters of either case", a and a.status == 200, a)
    a, _, _ = send(d, raw(POST, CHUNKED, body=b"2ac;x=\"y\"\r\n" + FILE + b"\r\n0\r\n\r\n"))
    check("chunk extensions: passed over, or (libmicrohttpd 1.0) refused",
          a and a.status == (400 if LIBRARY >= 1 else 200), a)


def test_continue(d):
    with Wire(d.port, PATIENCE) as w:
        w.send(raw(POST, LENGTH, "Expect: 100-continue"))
        first = w.read()
        check("who asks is told to go on", first and first[0].status == 100, *first)
        w.send(FILE)
        a = w.one()
        check("and gets his report", a and a.status == 200, a)
        w.send(raw(POST, LENGTH, "Expect: 100-continue", body=FILE))
        a = w.one()
        check("who does not wait, too", a and a.status == 200, a)
    refusals = {"a type": (415, [POST, LENGTH, "Content-Type: image/png"]),
                "a coding": (415, [POST, LENGTH, "Content-Encoding: br"]),
                "an option": (400, [POST.replace(MP, MP + "?x=1"), LENGTH]),
                "a path": (404, [POST.replace(MP, "/x"), LENGTH]),
                "a method": (405, [POST.replace("POST", "PUT"), LENGTH]),
                "a length": (413, [POST, "Content-Length: 2000000000000"]),
                "a type in chunks": (415, [POST, CHUNKED, "Content-Type: image/png"])}

    def cases():
        for name, (status, lines) in refusals.items():
            with Wire(d.port, PATIENCE) as w:
                w.send(raw(*lines, "Expect: 100-continue"))
                got = w.read()
                yield name, not got or got[0].status != status and str(got[0])

    check_all("a verdict known from the head is spoken instead of the 100", cases())
    for name, (status, lines) in list(refusals.items())[:5]:
        with Wire(d.port, PATIENCE) as w:
            w.send(raw(*lines))
            w.send(FILE)
            a = w.one()
            ok = a and a.status == status
            w.send(request())
            a = w.one() if ok else a
            check(f"{name}: who does not ask is answered behind the body, and may go on",
                  ok and a and a.status == 200, a)
    a, _, _ = send(d, raw(POST, LENGTH, "Expect: 200-maybe", body=FILE))
    check("another expectation is no reason to hang", a and a.status in (200, 417), a)


def test_nul(d):
    """libmicrohttpd before 1.0 cuts a value at a NUL and shows nobody the rest."""
    name = "NUL in a value is refused"
    faults = judge(d, raw("GET /livez HTTP/1.1", b"X-A: a\0b"), (400, None))
    if faults and "200" in faults[0]:
        print(f"# {name}: not by this libmicrohttpd")
    else:
        check(name, not faults, faults)


def test_no_spinning(d):
    """Who waits for a client does not burn the processor meanwhile."""
    waits = {"nothing": b"", "half a head": b"GET /livez HTTP/1.1\r\nHost: x\r\n",
             "half a body": raw(POST, LENGTH, body=FILE[:300]),
             "half a large body": raw(POST, "Content-Length: 9000000", body=FILE * 1000),
             "half a chunk": raw(POST, CHUNKED, body=b"1000\r\nabc"),
             "a chunk's number without end": CHUNKING["an endless number"],
             "an extension without end": raw(POST, CHUNKED, body=b"5;" + b"a" * 200000),
             "trailers without end": raw(POST, CHUNKED, body=b"0\r\nX: " + b"a" * 60000),
             "an idle connection": request()}

    def cases():
        polls, ticks = front(d.pid), os.sysconf("SC_CLK_TCK")
        for name, data in waits.items():
            with Wire(d.port, PATIENCE) as w:
                w.send(data)
                time.sleep(0.1)
                start = cpu(polls)
                time.sleep(0.4)
                burnt = (cpu(polls) - start) / ticks
            yield name, burnt > 0.25 and f"{burnt:.2f} s of 0.40 s"

    check_all("waiting costs nothing", cases())


with Daemon("--workers", "1", "--header-timeout", "400ms", "--body-timeout", "500ms") as hasty:
    test_tables(hasty)
with Daemon("--workers", "1", "--drain-timeout", "500ms") as daemon:
    test_nul(daemon)
    test_no_spinning(daemon)
    test_hosts(daemon)
    test_old_and_odd_forms(daemon)
    test_continue(daemon)
finish()
