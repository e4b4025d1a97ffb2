#!/usr/bin/env python3
"""Addresses: IPv6, several at once, those that are taken; --health at each of them."""
from contract import *
from harness import *
from wire import *

BOX = stl(box((0, 0, 0), (40, 30, 20)))


def has_ipv6():
    try:
        with socket.socket(socket.AF_INET6) as s:
            s.bind(("::1", 0))
        return True
    except OSError:
        return False


def health(*listen):
    return subprocess.run([PROGRAM, "--health", *(a for at in listen for a in ("--listen", at))],
                          capture_output=True, text=True, timeout=20)


def test_health():
    for listen in ("127.0.0.1:0", "0.0.0.0:0", "localhost:0", ":0"):
        with Daemon("--workers", "1", listen=listen, ready=False) as d:
            at = listen[:-1] + str(d.port)
            check(f"--health at {listen}", health(at).returncode == 0, health(at))
    done = health(at)
    check("--health where nobody listens: 1 and a word", done.returncode == 1 and at in done.stderr,
          done)


def test_ipv6():
    if not has_ipv6():
        print("# no IPv6 here")
        return
    for listen in ("[::1]:0", "[::]:0"):
        with Daemon("--workers", "1", "--log-format", "json", listen=listen, ready=False) as d:
            check(f"the URL of {listen} has brackets", d.url == f"http://{listen[:-2]}:{d.port}",
                  d.url)
            a = curl(f"http://[::1]:{d.port}/v1/mass-properties", "-H", "Content-Type: model/stl",
                     body=BOX)
            check(f"a mesh by IPv6 at {listen}", a.status == 200 and not common_faults(a)
                  and a.json["properties"]["volume"] == 24000, a)
            check("the client stands in the log", '"client":"::1"' in d.log(), d.log())
            at = f"{listen[:-2]}:{d.port}"
            check(f"--health at {listen}", health(at).returncode == 0, health(at))


def test_several():
    with Daemon("--workers", "1", listen="127.0.0.1:0,127.0.0.1:0") as d:
        second = d.process.stdout.readline().decode().strip()
        a = curl(second + "/livez")
        check("each address has its line and answers", second != d.url and a.status == 200, a)
        done = subprocess.run([PROGRAM, "--listen", f"127.0.0.1:{d.port}"], capture_output=True,
                              text=True, timeout=20)
        check("an address that is taken: 1 and a word", done.returncode == 1
              and "in use" in done.stderr and done.stdout == "", done)
        done = subprocess.run([PROGRAM, "--listen", "127.0.0.1:0", "--metrics-listen",
                               f"127.0.0.1:{d.port}"], capture_output=True, text=True, timeout=20)
        check("one for metrics that is taken likewise", done.returncode == 1
              and "in use" in done.stderr and done.stdout == "", done)


def test_few_descriptors():
    for count in (64, 128):
        done = subprocess.run(["sh", "-c", f"ulimit -n {count}; exec timeout 2 {PROGRAM} --workers 1 "
                               "--listen 127.0.0.1:0"], capture_output=True, text=True, timeout=20)
        served = done.stdout.startswith("http://")
        check(f"{count} descriptors: served, or a word on it",
              served or "Too many open files" in done.stderr, done)


test_health()
test_ipv6()
test_several()
test_few_descriptors()
finish()
