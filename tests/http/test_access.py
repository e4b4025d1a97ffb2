"""Who may ask: API keys, their rotation, and the listener that is kept for /metrics."""
import re

from family import *
from harness import *

PART = stl(box((0, 0, 0), (40, 30, 20)))


def bearer(key):
    return ("-H", f"Authorization: Bearer {key}")


def wait_log(daemon, text, seconds=10):
    end = time.monotonic() + seconds
    while text not in daemon.log() and time.monotonic() < end:
        time.sleep(0.02)
    return text in daemon.log()


def secrets_in(pid, secret):
    """Whether ${secret} stands anywhere in the memory that process ${pid} can write."""
    with open(f"/proc/{pid}/maps") as maps, open(f"/proc/{pid}/mem", "rb", 0) as mem:
        for line in maps:
            low, high = (int(x, 16) for x in line.split()[0].split("-"))
            if "rw" not in line.split()[1] or high - low > 1 << 28:
                continue
            try:
                mem.seek(low)
                if secret in mem.read(high - low):
                    return True
            except OSError:
                pass
    return False


with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "keys")

    def write(text):
        with open(path, "w") as f:
            f.write(text)

    write("# the shop\nshop-key-4711\n\nother-key-0815 # the other one\n")
    with Daemon("--api-key-file", path, "--workers", "1", "--cors-origin", "https://cad.test") as d:
        a = d.post(PART)
        check("without a key: 401 with the scheme and a problem",
              a.status == 401 and a.json["code"] == "unauthorized" and not a.json["retryable"] and
              a.headers["www-authenticate"] == 'Bearer realm="masspropd"', a)
        a = d.post(PART, *bearer("wrong"))
        check("a wrong key: 401, and the header says that the key is to blame",
              a.status == 401 and 'error="invalid_token"' in a.headers["www-authenticate"], a)
        for key in ("shop-key-4711", "other-key-0815"):
            a = d.post(PART, *bearer(key))
            check(f"key {key}: the report",
                  a.status == 200 and a.json["properties"]["volume"] == 24000, a)
        for wrong in ("the", "#", "shop-key-471", "shop-key-47111", "shop-key-4711 x"):
            check(f"{wrong!r} is none of them", d.post(PART, *bearer(wrong)).status == 401)
        check("the scheme counts", d.post(PART, "-H", "Authorization: Basic shop-key-4711").status
              == 401)
        a = d.raw(b"GET /v1/capabilities HTTP/1.1\r\nHost: x\r\nConnection: close\r\n" +
                  b"Authorization: Bearer shop-key-4711\r\n" * 2 + b"\r\n")
        check("two Authorization headers: 401", a.startswith(b"HTTP/1.1 401"), a)
        for probe in ("/livez", "/readyz"):
            check(f"{probe} asks for no key", d.get(probe).status == 200)
        for closed in ("/metrics", "/openapi.json", "/v1/capabilities", "/nowhere"):
            check(f"{closed} asks for a key", d.get(closed).status == 401)
            a = d.get(closed, *bearer("shop-key-4711"))
            check(f"{closed} with a key", a.status == (404 if closed == "/nowhere" else 200), a)
        a = d.curl("/v1/mass-properties", "-X", "OPTIONS", "-H", "Origin: https://cad.test", "-H",
                   "Access-Control-Request-Method: POST", "-H",
                   "Access-Control-Request-Headers: authorization")
        check("a preflight asks for no key and allows the header",
              a.status == 204 and "Authorization" in a.headers["access-control-allow-headers"], a)
        a = d.post(PART, "-H", "Origin: https://cad.test")
        check("a browser may read the 401",
              a.status == 401 and a.headers["access-control-allow-origin"] == "https://cad.test", a)
        a = d.post(PART, "-H", "Expect: 100-continue")
        check("who waits for 100 gets the 401 at once", a.status == 401 and a.interim == [], a)
        big = stl(box((0, 0, 0), (1, 1, 1)) * 40000)
        a = d.post(big, "-H", "Expect:")
        check("who sends all the same gets it behind the body", a.status == 401, a)
        polls, crew = front(d.pid), workers(d.pid)
        check("there are workers", len(crew) == 2, crew)
        if os.geteuid() == 0:
            held = [w for w in crew if secrets_in(w, b"shop-key-4711")]
            check("no worker has a key in its memory", not held, held)
            check("the front has (or the test above looks in vain)",
                  secrets_in(polls, b"shop-key-4711"))

        write("new-key-1\n")
        d.process.send_signal(signal.SIGHUP)
        check("SIGHUP: new keys", wait_log(d, "new ones are in force"), d.log())
        check("a new key opens", d.post(PART, *bearer("new-key-1")).status == 200)
        check("an old one no longer does", d.post(PART, *bearer("shop-key-4711")).status == 401)
        for bad, why in (("", "no key in it"), ("two words\n", "visible ASCII")):
            write(bad)
            d.process.send_signal(signal.SIGHUP)
            check(f"a key file with {bad!r} is refused", wait_log(d, why), d.log())
            check("the keys stay", d.post(PART, *bearer("new-key-1")).status == 200 and
                  d.post(PART).status == 401)
        os.remove(path)
        d.process.send_signal(signal.SIGHUP)
        check("a key file that is gone is refused", wait_log(d, "No such file"), d.log())
        check("the keys stay", d.post(PART, *bearer("new-key-1")).status == 200)
        write("newest\n")
        d.process.send_signal(signal.SIGHUP)
        check("another rotation", wait_log(d, "new ones are in force"), d.log())
        kill(front(d.pid))
        d.wait_ready()
        check("a front that is new has the keys of now",
              d.post(PART, *bearer("newest")).status == 200 and
              d.post(PART, *bearer("new-key-1")).status == 401)
        check("no key is in the log", not re.search("shop-key|new-key|newest", d.log()), d.log())

    write("# nothing\n")
    for text, flags in (("no key in it", (path,)), ("No such file", (path + "x",)),
                        ("not a plain file", (folder,))):
        done = subprocess.run([PROGRAM, "--listen", "127.0.0.1:0", "--api-key-file", *flags],
                              capture_output=True, text=True, timeout=20)
        check(f"no start with a bad key file ({text})",
              done.returncode == 1 and text in done.stderr and done.stdout == "", done)

with Daemon("--workers", "1") as d:
    d.process.send_signal(signal.SIGHUP)
    time.sleep(0.2)
    check("SIGHUP without a key file changes nothing", d.post(PART).status == 200)

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "keys")
    with open(path, "w") as f:
        f.write("the-key\n")
    with Daemon("--metrics-listen", "127.0.0.1:0", "--api-key-file", path, "--workers", "1") as d:
        inside = d.process.stdout.readline().decode().strip()
        found = re.fullmatch(r"(http://127\.0\.0\.1:\d+)/metrics", inside)
        check("the second line is where the metrics are", found, inside)
        base = found.group(1)
        a = curl(base + "/metrics")
        check("metrics without a key", a.status == 200 and b"masspropd_" in a.body, a)
        for probe in ("/livez", "/readyz"):
            check(f"{probe} is there as well", curl(base + probe).status == 200)
        for path in ("/v1/capabilities", "/openapi.json"):
            check(f"{path} is not", curl(base + path).status == 404)
        a = curl(base + "/v1/mass-properties", "-H", "Content-Type: model/stl", body=PART)
        check("no mesh is taken there", a.status == 404, a)
        check("/metrics has left the other one", d.get("/metrics", *bearer("the-key")).status == 404)
        check("which works", d.post(PART, *bearer("the-key")).status == 200)
    with Daemon("--metrics-listen", "127.0.0.1:0", "--memory", "64MB", "--workers", "1") as d:
        base = d.process.stdout.readline().decode().strip().removesuffix("/metrics")
        crowd = [d.connect() for _ in range(300)]
        turned_away = d.raw(b"GET /livez HTTP/1.1\r\nHost: x\r\n\r\n")
        a = curl(base + "/livez")
        check("who looks after the service is heard in any crowd",
              b" 503 " in turned_away and a.status == 200, f"{turned_away} {a}")
        for s in crowd:
            s.close()
finish()
