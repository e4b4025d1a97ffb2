#!/usr/bin/env python3
"""masspropd calc, and what the program says without serving."""
from contract import *
from harness import *

BOX = box((0, 0, 0), (40, 30, 20))
QUERY = {"density": "2700", "unit": "mm", "about": "1,2,3", "axis": "1,2,3", "axis_origin": "1,0,0"}
CLEAN = {k: v for k, v in os.environ.items() if not k.startswith("MASSPROPD_")}


def run(*args, data=b"", env=None, timeout=60):
    return subprocess.run([PROGRAM, *args], input=data, capture_output=True, timeout=timeout,
                          env={**CLEAN, **(env or {})})


def said(p):
    return f"exit {p.returncode}\n{p.stdout[:1500]!r}\n{p.stderr[:1500]!r}"


def write(folder, name, data):
    path = os.path.join(folder, name)
    with open(path, "wb") as f:
        f.write(data)
    return path


def test_table(files):
    p = run("calc", "--density", "2700", "--unit=mm", files["box"])
    text = p.stdout.decode()
    check("a table for people", p.returncode == 0 and not p.stderr
          and all(w in text for w in ("box.stl", "24000 mm3", "0.0648 kg", "5200 mm2",
                                      "20, 15, 10 mm", "12 triangles", "solid")), said(p))
    check("whose lines fit a window", max(map(len, text.splitlines())) <= 100, text)
    p = run("calc", files["open"])
    text = p.stdout.decode()
    check("an open mesh is said to be open", p.returncode == 0 and "boundary edges" in text
          and "not closed" in text and "NO" in text, said(p))
    p = run("calc", files["two"])
    check("bodies are listed", p.returncode == 0 and b"body 0" in p.stdout
          and b"body 1" in p.stdout, said(p))
    p = run("calc", files["nasty"])
    check("what the file says cannot reach the terminal's controls", p.returncode == 0
          and not any(c < 32 and c != 10 for c in p.stdout) and b"\x7f" not in p.stdout, said(p))


def rows_of(p):
    """Label: text, of a table; what a row goes on with is one text with it."""
    rows, last = {}, None
    for line in p.stdout.decode().splitlines()[1:]:
        label, text = line[2:22].strip(), " ".join(line[22:].split())
        last = label or last
        rows[last] = f"{rows[last]} | {text}" if last in rows else text
    return rows


def test_rows(folder, files):
    """What Alpha_1's calc did, row by row."""
    def said_rows(name, args, **want):
        p = run("calc", "--unit=mm", *args)
        rows = rows_of(p)
        wrong = {k: rows.get(k.replace("_", " ")) for k, v in want.items()
                 if rows.get(k.replace("_", " ")) != v}
        check(f"calc: {name}", p.returncode == 0 and not wrong, f"{wrong}\n{said(p)}")
        return rows

    box_file = files["box"]
    said_rows("density in the file's units", ["--density=2", "--density_unit=file", box_file],
              mass="48000 file", density="2 file",
              inertia_at_centroid="5200000 0 0 file.mm2 | 0 8000000 0 | 0 0 10000000")
    said_rows("flip", ["--flip", box_file], volume="24000 mm3",
              solid="NO: closed, watertight, orientation inward")
    rows = said_rows("an axis through the origin", ["--density=2700", "--axis=0,0,2", box_file],
                     axis_along="0, 0, 1", axis_through="0, 0, 0 mm",
                     moment_about_axis="54 kg.mm2")
    check("calc: nothing about a point that nobody asked for", "point" not in rows, rows)
    said_rows("an axis elsewhere",
              ["--density=2700", "--axis", "1,0,0", "--axis_origin", "7,15,10", box_file],
              axis_along="1, 0, 0", axis_through="7, 15, 10 mm", moment_about_axis="7.02 kg.mm2",
              radius_of_gyration="10.40833 mm")
    said_rows("a point", ["--density=2700", "--about=20,15,11", box_file], point="20, 15, 11 mm",
              inertia_at_point="7.0848 0 0 kg.mm2 | 0 10.8648 0 | 0 0 13.5")
    said_rows("a transformation", ["--transform", "-1,0,0,5,0,2,0,0,0,0,1,0", box_file],
              transform="-1 0 0 5 | 0 2 0 0 | 0 0 1 0", size="40 x 60 x 20 mm",
              volume="48000 mm3", centroid="-15, 30, 10 mm",
              solid="yes: closed, watertight, orientation outward")

    halves = [write(folder, "lower.stl", stl(BOX[:7])), write(folder, "upper.stl", stl(BOX[7:]))]
    said_rows("files that are one solid together", ["--together", *halves], volume="24000 mm3",
              centroid="20, 15, 10 mm", solid="yes: closed, watertight, orientation outward")
    p = run("calc", "--unit=mm", "--together", "--transform=2,0,0,0,0,1,0,0,0,0,1,0", *halves)
    check("calc: mapped together", rows_of(p).get("volume") == "48000 mm3", said(p))

    point, line = ((1, 1, 1),) * 3, ((0, 0, 0), (2, 0, 0), (1, 0, 0))
    flat = write(folder, "flat.stl", stl([*BOX, point, line, ((0, 0, 0), (1, 0, 0), (2, 0, 0))]))
    rows = said_rows("degenerate faces are counted, and add nothing", [flat], volume="24000 mm3",
                     surface_area="5200 mm2", degenerate="3")
    check("calc: and a warning says so", "warning" in rows, rows)
    sheet = write(folder, "sheet.stl", stl([*BOX[:2], *flip(BOX[:2])]))
    rows = said_rows("an object of volume 0 is reported", ["--density=2700", sheet],
                     volume="0 mm3", mass="0 kg", centroid="-")
    check("calc: and a warning says so, but it is no failure", "volume" in rows.get("warning", ""),
          rows)
    p = run("calc", "--strict", sheet)
    check("calc: under --strict it is one", p.returncode == 1 and b"volume" in p.stderr, said(p))
    point_file = write(folder, "point.stl", stl([point] * 4))
    p = run("calc", "--unit=mm", point_file)
    check("calc: nothing but degenerate faces", p.returncode == 0
          and rows_of(p).get("degenerate") == "4" and rows_of(p).get("surface area") == "0 mm2",
          said(p))
    p = run("calc", "--transform=1,2,3,0,2,4,6,0,0,0,1,0", box_file)
    check("calc: a singular transformation", p.returncode == 2 and b"--transform" in p.stderr,
          said(p))
    p = run("calc", "--transform=1e307,0,0,0,0,1,0,0,0,0,1,0", box_file)
    check("calc: one beyond the range", p.returncode == 2 and b"box.stl" in p.stderr
          and b"range" in p.stderr, said(p))


def test_readme(folder):
    """The commands of the README, and what it says that they print."""
    with open("README.md", encoding="utf-8") as f:
        shown = f.read().partition("### Calc, row by row")[2].split("```")[1].strip("\n") + "\n"
    said_there = [c.partition("\n") for c in re.split(r"^\$ ", shown, flags=re.M)[1:]]
    os.makedirs(os.path.join(folder, "build"), exist_ok=True)
    os.symlink(os.path.abspath(PROGRAM), os.path.join(folder, "build", "masspropd"))

    def cases():
        for command, _, want in said_there:
            p = subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, env=CLEAN,
                               timeout=60)
            yield command, p.stdout.decode() != want and said(p)

    check("the README has commands to show", len(said_there) >= 8, said_there)
    check_all("and they print what it says", cases())


def test_json(d, files):
    query = "&".join(f"{k}={v}" for k, v in QUERY.items())
    flags = [f"--{k}={v}" for k, v in QUERY.items()]

    def cases():
        for name, path in files.items():
            with open(path, "rb") as f:
                service = untimed(d.post(f.read(), query=query).json)
            p = run("calc", "--json", *flags, path)
            report = untimed(json.loads(p.stdout))
            yield name, p.returncode != 0 and said(p)
            yield name, report["input"].pop("filename") != os.path.basename(path)
            service["input"].pop("filename")
            yield name, report != service and differences(service, report)

    check_all("--json is what the service answers", cases())
    several = [files["box"], files["open"], files["box"]]
    p = run("calc", "--json", *several)
    lines = p.stdout.decode().splitlines()
    check("several files: one report a line, in order", p.returncode == 0 and len(lines) == 3
          and [json.loads(x)["input"]["filename"] for x in lines]
          == ["box.stl", "open.stl", "box.stl"], said(p))


def test_exit(files, folder):
    bad = write(folder, "bad.stl", b"no mesh")
    missing = os.path.join(folder, "missing.stl")
    for name, want, args in (
            ("a solid under --strict", 0, ["--strict", files["box"]]),
            ("--strict=true", 0, ["--strict=true", files["box"]]),
            ("no solid", 0, [files["open"]]),
            ("no solid under --strict", 1, ["--strict", files["open"]]),
            ("--strict true", 1, ["--strict", "true", files["open"]]),
            ("--strict false", 0, ["--strict", "false", files["open"]]),
            ("no mesh", 2, [bad]), ("no file", 2, [missing]), ("a folder", 2, [folder]),
            ("nothing", 2, []), ("the worst counts", 2, ["--strict", files["open"], bad]),
            ("in either order", 2, ["--strict", missing, files["box"], files["open"]]),
            ("an unknown option", 2, ["--colour", "red", files["box"]]),
            ("a malformed option", 2, ["--density", "x", files["box"]]),
            ("an option of a later stage", 2, ["--resolution=1e-6", files["box"]]),
            ("an option without its value", 2, [files["box"], "--density"]),
            ("exclusive options", 2, ["--density=1", "--mass=1", files["box"]]),
            ("a repeated option", 2, ["--density=1", "--density=1", files["box"]])):
        p = run("calc", *args)
        words = p.stderr.startswith(b"masspropd calc: ") if want else not p.stderr
        check(f"exit {want}: {name}", p.returncode == want and words, said(p))
    p = run("calc", bad, files["box"])
    check("a bad file does not keep the others", p.returncode == 2 and b"24000" in p.stdout
          and b"bad.stl" in p.stderr, said(p))
    p = run("calc", "--colour=red", files["box"])
    check("the message names the option", b"colour" in p.stderr, said(p))


def test_input(files):
    with open(files["box"], "rb") as f:
        data = f.read()
    p = run("calc", "--json", "--density=2700", "-", data=data)
    r = json.loads(p.stdout or b"{}")
    check("- is standard input", p.returncode == 0 and at(r, "properties.mass") == 0.0648
          and at(r, "input.filename") is None, said(p))
    p = run("calc", "-", data=b"")
    check("which may be empty", p.returncode == 2 and p.stderr, said(p))
    p = run("calc", "--flip", files["box"], "--json")
    check("options may stand behind files, booleans alone",
          at(json.loads(p.stdout or b"{}"), "properties.signed_volume") == -24000, said(p))
    p = run("calc", "--json", "--bodies", "1", files["odd name"])
    check("a name with blanks and letters", p.returncode == 0
          and json.loads(p.stdout)["input"]["filename"] == "odd \u00e9 name.stl", said(p))


def test_program(d):
    p = run("--version")
    check("--version", p.returncode == 0 and re.fullmatch(rb"masspropd \d+\.\d+\.\d+\n", p.stdout),
          said(p))
    p = run("--help")
    flags = re.findall(r"^  --([a-z-]+)", p.stdout.decode(), re.M)
    check("--help lists the flags", p.returncode == 0 and {"listen", "workers", "max-body",
                                                           "drain-delay"} <= set(flags), said(p))
    p = run("calc", "--help")
    check("calc --help lists the options", p.returncode == 0
          and all(b"--" + o in p.stdout for o in (b"json", b"density", b"axis_origin", b"strict")),
          said(p))
    p = run("--health", "--listen", f"127.0.0.1:{d.port}")
    check("--health of a living daemon", p.returncode == 0, said(p))
    p = run("--health", env={"MASSPROPD_LISTEN": f"0.0.0.0:{d.port}"})
    check("--health where 0.0.0.0 means loopback", p.returncode == 0, said(p))
    with socket.socket() as s:  # a port where nobody listens
        s.bind(("127.0.0.1", 0))
        p = run("--health", f"--listen=127.0.0.1:{s.getsockname()[1]}")
    check("--health of nothing", p.returncode == 1 and p.stderr, said(p))
    for name, args, env in (("an unknown flag", ["--bogus"], {}),
                            ("a value that is none", ["--workers", "many"], {}),
                            ("a flag without a value", ["--workers"], {}),
                            ("an address that is none", ["--listen", "nonsense"], {}),
                            ("a port that is taken", ["--listen", f"127.0.0.1:{d.port}"], {}),
                            ("an unknown variable", [], {"MASSPROPD_BOGUS": "1"}),
                            ("a variable's bad value", [], {"MASSPROPD_WORKERS": "0"})):
        p = run(*args, env=env)
        lines = p.stderr.decode().splitlines()
        check(f"{name}: no start, one line why", p.returncode in (1, 2) and not p.stdout
              and len(lines) == 1 and lines[0].startswith("masspropd: "), said(p))


def test_settings():
    env = {"MASSPROPD_WORKERS": "3", "MASSPROPD_MAX_BODY": "1kB", "MASSPROPD_LOG_FORMAT": "json",
           "MASSPROPD_MAX_TRIANGLES": "1k"}
    with Daemon("--max-triangles", "2k", env=env) as d:
        c = d.get("/v1/capabilities").json
        check("variables are settings, flags outweigh them", c["limits"]["workers"] == 3
              and c["limits"]["max_body"] == 1000 and c["limits"]["max_triangles"] == 2000, c)
        d.post(stl(BOX), "-H", "X-Request-Id: find-me", query="unit=mm")
        lines = [json.loads(x) for x in d.log().splitlines()]
        mine = [x for x in lines if x.get("request_id") == "find-me"]
        check("the log is JSON, a line a request", len(mine) == 1 and mine[0]["status"] == 200
              and mine[0]["received"] == 684, d.log())


with tempfile.TemporaryDirectory() as tmp, Daemon("--workers", "1") as daemon:
    nasty = stl_ascii(BOX, "NAME").replace(b"NAME", b"a\xc2\x85[31m \xc2\x9b1m \t\xff")
    made = {"box": write(tmp, "box.stl", stl(BOX)), "open": write(tmp, "open.stl", stl(BOX[2:])),
            "text": write(tmp, "text.stl", stl_ascii(BOX, "part 1")),
            "two": write(tmp, "two.stl", stl(BOX + box((100, 0, 0), (1, 1, 1)))),
            "torus": write(tmp, "torus.stl", stl(torus((1, 2, 3), 10, 3))),
            "nasty": write(tmp, "nasty.stl", nasty),
            "odd name": write(tmp, "odd \u00e9 name.stl", stl(BOX))}
    test_table(made)
    test_rows(tmp, made)
    test_readme(tmp)
    test_json(daemon, made)
    test_exit(made, tmp)
    test_input(made)
    test_program(daemon)
test_settings()
finish()
