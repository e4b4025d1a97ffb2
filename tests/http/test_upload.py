#!/usr/bin/env python3
"""Forms, compressed bodies and several files: the real curl, gzip and zstd."""
import gzip

from contract import *
from harness import *
from wire import *

MOST = 3_000_000  # --max-decoded
BOX = box((0, 0, 0), (40, 30, 20))
FILE = stl(BOX)
OTHER = stl(box((100, 0, 0), (10, 10, 10)))
BALL = stl(sphere((1, 2, 3), 5, 100))  # 1 MB: spooled, and curl waits for 100-continue
FORM = "multipart/form-data; boundary=XX"
URL = "/v1/mass-properties"


def zstd(data, *flags):
    return subprocess.run(["zstd", "-cq", *flags], input=data, capture_output=True,
                          check=True).stdout


def part(name, data, filename=None, head=""):
    name = f'--XX\r\nContent-Disposition: form-data; name="{name}"'
    if filename is not None:
        name += f'; filename="{filename}"'
    return name.encode() + b"\r\n" + head.encode() + b"\r\n" + data + b"\r\n"


def form(*parts):
    return b"".join(parts) + b"--XX--\r\n"


def same(answer, want, **name):
    """Is ${answer} the report ${want}, but for the times and, where given, the input's names?"""
    got, want = untimed(answer.json), untimed(want.json)
    want["input"] = {**want["input"], **name}
    return answer.status == 200 and got == want


def test_curl_forms(d, files):
    want = d.post(FILE, query="density=2700&unit=cm&defects=3&about=1,2,3")
    mesh = "file=@" + files["box.stl"]
    options = [("density", "2700"), ("unit", "cm"), ("defects", "3"), ("about", "1,2,3")]
    fields = [["-F", f"{k}={v}"] for k, v in options]
    for before in range(len(fields) + 1):
        args = sum(fields[:before], []) + ["-F", mesh] + sum(fields[before:], [])
        a = d.curl(URL, *args)
        check(f"a form with {before} options before the file", same(a, want, filename="box.stl"), a)
    a = d.curl(URL + "?density=2700&unit=cm", "-F", mesh, *fields[2], *fields[3])
    check("options in the query and in the form", same(a, want, filename="box.stl"), a)
    for query, args, option in (("", [*fields[0], *fields[0]], "density"),
                                ("?density=2700", fields[0], "density"),
                                ("?mass=1", fields[0], "mass"),
                                ("", ["-F", "unit=parsec"], "unit")):
        for args in (["-F", mesh, *args], [*args, "-F", mesh]):
            check_problem(f"refused: {query} {args[1]} {args[3]}", d.curl(URL + query, *args), 400,
                          "bad_option", option=option)
    check_problem("an option that does not exist", d.curl(URL, "-F", mesh, "-F", "colour=red"),
                  400, "unknown_option", option="colour")
    for extra in ([], ["-H", "Transfer-Encoding: chunked"], ["-H", "Expect:"],
                  ["-H", "Expect: 100-continue"], ["--http1.0"]):
        a = d.curl(URL, "-F", "file=@" + files["ball.stl"], *extra)
        check(f"a form of a megabyte {extra}", same(a, d.post(BALL), filename="ball.stl"), a)
    for name in ("a b.stl", "caf\u00e9.stl", "a;b=c,d.stl", "..", "C:\\dir\\x.stl"):
        a = d.curl(URL, "-F", f'file=@"{files["box.stl"]}";filename="{name}"')
        check(f"a file called {name}", a.status == 200, a)
    a = d.curl(URL, "-F", "file=<" + files["ascii.stl"])
    check("a part named file needs no filename", same(a, d.post(stl_ascii(BOX))), a)
    a = d.curl(URL, "-F", "part=@" + files["box.stl"])
    check("a part with a filename needs no name", same(a, d.post(FILE), filename="box.stl"), a)


def test_several_files(d, files):
    mesh = ["-F", "file=@" + files["box.stl"]]
    more = ["-F", "file=@" + files["other.stl"]]
    a = d.curl(URL, *mesh, "-F", "density=1000", *more, "-F", "bodies=1")
    r = a.json
    check("two files are one solid", a.status == 200 and at(r, "properties.volume") == 25000
          and at(r, "mesh.bodies") == 2 and len(r["bodies"]) == 1
          and at(r, "input.filenames") == ["box.stl", "other.stl"]
          and at(r, "input.bytes") == len(FILE) + len(OTHER), a)
    a = d.curl(URL, *more, "-F", "file=@" + files["ascii.stl"])
    check("of two formats", a.status == 200 and at(a.json, "properties.volume") == 25000
          and at(a.json, "input.format") == "mixed", a)
    a = d.curl(URL, "-F", "file=@" + files["box.mtl"], *mesh, "-F", "skin=@" + files["skin.png"])
    check("materials and pictures are passed over", same(
        a, d.post(FILE), filename="box.stl") is False and a.status == 200
        and warnings(a.json) == {"unit_assumed", "attachment_ignored"}
        and "filenames" not in a.json["input"], a)
    a = d.curl(URL, "-F", "file=@" + files["box.mtl"])
    check_problem("and are no mesh", a, 400, "bad_multipart")
    a = d.curl(URL, *mesh, "-F", "file=@" + files["empty.stl"])
    check_problem("an empty file among them", a, 422, "empty")
    check("is named", "empty.stl" in a.json["detail"], a)
    a = d.curl(URL, *mesh, "-F", "file=@" + files["cut.stl"], *more)
    check_problem("a file that is cut off among them", a, 422, "truncated", byte=len(FILE) - 1)
    check("is named, too", "cut.stl" in a.json["detail"], a)
    a = d.curl(URL, *mesh, "-F", "format=stl", *more)
    check("a format that fits may follow", a.status == 200, a)
    a = d.curl(URL, *mesh, "-F", "format=drc")
    check_problem("one that does not may not", a, 400, "bad_option", option="format")


def test_odd_forms(d):
    file = part("file", FILE, "a.stl")
    good = {"a preamble and an epilogue": b"For MIME.\r\n" + form(file) + b"\r\n--XX\r\nfoo",
            "no line end behind the last boundary": form(file)[:-2],
            "blanks behind boundaries": form(file).replace(b"--XX\r\n", b"--XX \t\r\n"),
            "folded headers": form(part("file", FILE, "a.stl", "X-A:\r\n b\r\n\tc\r\n")),
            "an encoding that is none": form(
                part("file", FILE, "a.stl", "Content-Transfer-Encoding: binary\r\n")),
            "data like boundaries": form(part("file", FILE + b"\r\n--X\r\n--XXX--XX\r--XX--",
                                              "a.stl"))}
    for name, data in good.items():
        a = d.post(data, content_type=FORM)
        check(name, a.status == 200 and at(a.json, "properties.volume") == 24000, a)
    a = d.post(form(file).replace(b"--XX", b"--a b'(c)"),
               content_type="Multipart/Form-Data; charset=x; Boundary=\"a b'(c)\"")
    check("a boundary in quotes", a.status == 200, a)
    bad = {"nothing": b"", "no boundary line": FILE, "another boundary": form(file).replace(
               b"XX", b"XY"), "no file": form(part("unit", b"mm")), "no parts": form(),
           "no last boundary": form(file)[:-4], "no name": form(file).replace(b'name="file"; ', b""),
           "LF alone": form(part("file", stl_ascii(BOX))).replace(b"\r\n", b"\n"),
           "no disposition": form(b"--XX\r\n\r\n" + FILE + b"\r\n"),
           "base64": form(part("file", b"AA==", "a", "Content-Transfer-Encoding: base64\r\n")),
           "a form in it": form(part("file", b"", None, "Content-Type: multipart/mixed\r\n")),
           "a head of 9000 bytes": form(part("file", FILE, "a.stl", "X: " + 9000 * "x" + "\r\n")),
           "1001 parts": form(*(1001 * [part("file", FILE, "a.png")]))}
    for name, data in bad.items():
        check_problem(f"a form with {name}", d.post(data, content_type=FORM), 400, "bad_multipart")
    for kind in ("", ";", "; boundary=", "; boundary=a*b", '; boundary="a ', "; boundary=" + 71 * "x"):
        a = d.post(form(file), content_type="multipart/form-data" + kind)
        check_problem(f"Content-Type ...{kind[:20]}", a, 400, "bad_multipart")
    a = d.post(form(part("unit", 17000 * b"m"), file), content_type=FORM)
    check_problem("an option of 17000 bytes", a, 400, "bad_option", option="unit", limit=16384)

    def cases():
        data = form(part("density", b"2700"), file, part("unit", b"cm"))
        want = d.post(FILE, query="density=2700&unit=cm")
        for size in (1, 2, 3, 7, 64):
            pieces = [data[i:i + size] for i in range(0, len(data), size)]
            head = (f"POST {URL} HTTP/1.1\r\nHost: x\r\nConnection: close\r\nContent-Type: {FORM}"
                    "\r\nTransfer-Encoding: chunked\r\n\r\n").encode()
            got = replies(d.raw(head + chunked(pieces)))[-1]
            yield f"pieces of {size}", not same(got, want, filename="a.stl") and str(got)
    check_all("a form that comes in small pieces", cases())


def test_codings(d):
    want, ball = d.post(FILE, query="density=1"), d.post(BALL, query="density=1")
    half = len(FILE) // 2
    two = gzip.compress(FILE[:half]) + gzip.compress(b"") + gzip.compress(FILE[half:])
    frames = zstd(FILE[:half]) + b"\x5a\x2a\x4d\x18\x03\0\0\0abc" + zstd(FILE[half:], "--no-check")
    good = [("gzip", gzip.compress(FILE)), ("x-gzip", gzip.compress(FILE, 1)),
            ("GZIP", gzip.compress(FILE, 0)), ("identity, gzip", two), ("gzip", two + bytes(600)),
            ("gzip", gzip.compress(BALL)), ("zstd", zstd(FILE)), ("zstd", zstd(FILE, "-19")),
            ("zstd", zstd(FILE, "--ultra", "-22", "--long=27")), ("zstd", frames),
            ("zstd", zstd(BALL)), ("identity", FILE)]

    def cases():
        for coding, data in good:
            large = len(data) > len(FILE) + 1000
            for extra in ([], ["-H", "Transfer-Encoding: chunked"]):
                a = d.post(data, "-H", f"Content-Encoding: {coding}", *extra, query="density=1")
                yield f"{coding}, {len(data)} bytes {extra}", not same(
                    a, ball if large else want) and str(a)
    check_all("what gzip and zstd make is read", cases())

    def bad(coding, data):
        return problem_faults(d.post(data, "-H", f"Content-Encoding: {coding}"), 400,
                              "bad_encoding", byte=True)

    def broken():
        for coding, data in (("gzip", gzip.compress(FILE)), ("zstd", zstd(FILE))):
            for n in sorted({0, 1, 2, 9, 10, 11, len(data) // 2, len(data) - 9, len(data) - 1}):
                yield f"{coding} cut to {n}", bad(coding, data[:n])
            yield f"{coding}, a bad check", bad(coding, data[:-5] + bytes([data[-5] ^ 1]) + data[-4:])
            yield f"{coding}, garbage behind it", bad(coding, data + b"what is this?")
            yield f"{coding} that is none", bad(coding, FILE)
        yield "gzip for zstd", bad("zstd", gzip.compress(FILE))
        yield "zstd for gzip", bad("gzip", zstd(FILE))
        yield "zlib for gzip", bad("gzip", b"\x78\x9c\x03\x00\x00\x00\x00\x01")
        yield "a window of 2 GiB", bad("zstd", zstd(FILE, "--ultra", "-22", "--long=31"))
    check_all("what is damaged is bad_encoding", broken())
    check_problem("nothing, compressed", d.post(gzip.compress(b""), "-H", "Content-Encoding: gzip"),
                  422, "empty")
    for name, data in (("gzip", gzip.compress(BALL)), ("zstd", zstd(BALL)), ("zip", b"PK\3\4" + BALL)):
        a = d.post(data)
        check_problem(f"{name} that no header tells of", a, 422, "unreadable")
        check(f"is named: {name}", name in a.json["detail"], a)
    data = form(part("density", b"1"), part("file", BALL, "ball.stl"))
    for coding, packed in (("gzip", gzip.compress(data)), ("zstd", zstd(data))):
        a = d.post(packed, "-H", f"Content-Encoding: {coding}", content_type=FORM)
        check(f"a form in {coding}", same(a, ball, filename="ball.stl"), a)


def test_bombs(d):
    zeros = bytes(100_000_000)
    for coding, data in (("gzip", gzip.compress(zeros)), ("zstd", zstd(zeros)),
                         ("gzip", 10 * gzip.compress(zeros[:10_000_000]))):
        for extra in ([], ["-H", "Transfer-Encoding: chunked"]):
            a = d.post(data, "-H", f"Content-Encoding: {coding}", *extra)
            check_problem(f"100 MB of zeros as {len(data)} bytes of {coding} {extra}", a, 413,
                          "decoded_too_large", limit=MOST, actual=MOST + 1)
        a = d.post(form(part("file", data)), content_type=FORM)
        check(f"a bomb as a file is a file ({coding})", a.status == 422, a)
    data = gzip.compress(form(part("unit", zeros)))
    a = d.post(data, "-H", "Content-Encoding: gzip", content_type=FORM)
    check_problem("100 MB as an option", a, 413, "decoded_too_large", limit=MOST)
    data = gzip.compress(form(part("file", zeros, "a.png")))
    a = d.post(data, "-H", "Content-Encoding: gzip", content_type=FORM)
    check_problem("100 MB as a picture", a, 413, "decoded_too_large", limit=MOST)
    exact = stl(BOX) + bytes(MOST - len(FILE))
    a = d.post(gzip.compress(exact), "-H", "Content-Encoding: gzip")
    check("the limit itself is no matter", a.status == 200, a)
    check_problem("one byte more is", d.post(gzip.compress(exact + b"x"),
                                             "-H", "Content-Encoding: gzip"), 413,
                  "decoded_too_large", limit=MOST, actual=MOST + 1)


def test_together(files):
    def calc(*args):
        return subprocess.run([PROGRAM, "calc", *args], capture_output=True, timeout=60,
                              input=FILE)

    p = calc("--json", "--together", "--density=1000", files["other.stl"], "-")
    r = json.loads(p.stdout)
    check("calc --together: files are one solid", p.returncode == 0
          and at(r, "properties.volume") == 25000 and at(r, "mesh.bodies") == 2
          and at(r, "input.filenames") == ["other.stl", None], p)
    p = calc("--together", files["box.stl"], files["other.stl"])
    check("calc --together: the table names them", b"box.stl + other.stl: " in p.stdout, p)
    p = calc("--json", files["box.stl"], files["other.stl"])
    check("without it each is one of its own", p.returncode == 0
          and [json.loads(line)["properties"]["volume"] for line in p.stdout.splitlines()]
          == [24000, 1000], p)
    p = calc("--together", files["box.stl"], files["cut.stl"], files["other.stl"])
    check("calc --together: a bad file is named", p.returncode == 2 and b"cut.stl" in p.stderr
          and not p.stdout, p)
    p = calc("--together", files["box.stl"], "/does/not/exist")
    check("calc --together: a missing one, too", p.returncode == 2
          and b"/does/not/exist" in p.stderr and not p.stdout, p)
    p = calc("--together", "--strict", files["box.stl"], files["open.stl"])
    check("calc --together --strict: the whole is judged", p.returncode == 1, p)


with tempfile.TemporaryDirectory() as folder:
    files = {}
    for name, data in (("box.stl", FILE), ("other.stl", OTHER), ("ball.stl", BALL),
                       ("ascii.stl", stl_ascii(BOX)), ("cut.stl", FILE[:-1]), ("empty.stl", b""),
                       ("open.stl", stl(box((200, 0, 0), (1, 1, 1))[1:])),
                       ("box.mtl", b"newmtl a\n"), ("skin.png", b"\x89PNG\r\n\x1a\n")):
        files[name] = os.path.join(folder, name)
        with open(files[name], "wb") as f:
            f.write(data)
    with Daemon("--workers", "1", "--max-decoded", str(MOST)) as d:
        test_curl_forms(d, files)
        test_several_files(d, files)
        test_odd_forms(d)
        test_codings(d)
        test_bombs(d)
    test_together(files)
finish()
