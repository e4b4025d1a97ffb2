#!/usr/bin/env python3
"""Attacks that once worked: each of these held the daemon up, leaked, or fell on somebody else."""
# tests/run: alone
import fcntl
import random
import struct

from contract import *
from family import *
from harness import *
from wire import *

FILE = stl(box((0, 0, 0), (40, 30, 20)))
CHUNKED = b"POST /v1/mass-properties HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
MIB = 1 << 20


def in_flight(d):
    """Requests between head and answer, without the one that asks."""
    return int(re.search(r"in flight: (\d+)", d.get("/readyz?verbose").body.decode())[1]) - 1


def reset(w):
    """Leave without a farewell."""
    w.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    w.socket.close()


def test_limit_at_a_full_ring():
    """The byte too many comes with the piece that the ring takes only in part."""
    with Daemon("--workers", "1", "--max-body", str(MIB - 100)) as d, Wire(d.port) as w:
        crew = workers(d.pid)
        kill(*crew, sig=signal.SIGSTOP)
        w.send(CHUNKED + chunked([bytes(60000)] * 35))
        a = w.one()
        check("over the limit while the worker is behind: answered all the same",
              a and a.status == 413, a)
        kill(*crew, sig=signal.SIGCONT)


def test_far_beyond_the_limit():
    with Daemon("--workers", "1", "--max-body", "1MiB") as d, Wire(d.port) as w:
        w.send(CHUNKED)
        piece = b"100000\r\n" + bytes(MIB) + b"\r\n"
        sent = 0
        while sent < 200 and w.send(piece):
            sent += 1
        a = w.one()
        check("who sends on and on behind a verdict is cut off, with the verdict",
              sent < 200 and a and a.status in (413, 422), f"{sent} MiB, {a}")


def test_many_parameters(d):
    """The library refuses these by itself and does not say that the request is over."""
    for _ in range(20):
        d.raw(request(path="/livez?" + "a&" * 3000), timeout=5)
    check("requests that the library gives up are forgotten", until(lambda: in_flight(d) == 0, 3),
          in_flight(d))


def test_log(d):
    for method in ('A","x":"y', "A\x1b[2J", "A\\"):
        ask(d.port, request(method, "/odd"))

    def lines():
        return [x for x in d.log().splitlines() if "/odd" in x]

    until(lambda: len(lines()) == 3, 5)
    good = []
    for line in lines():
        try:
            good.append("x" not in json.loads(line) and line.isprintable())
        except ValueError:
            good.append(False)
    check("a method cannot write into the log", good == [True] * 3, "\n".join(lines()))


def test_log_that_nobody_reads():
    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)
    p = subprocess.Popen([PROGRAM, "--listen", "127.0.0.1:0"], stdin=subprocess.DEVNULL,
                         stdout=subprocess.PIPE, stderr=writer)
    port = int(p.stdout.readline().decode().rpartition(":")[2])
    answers = 0
    while answers < 200:
        a = ask(port, request(path="/nothing"), 5)
        if not a or a.status != 404:
            break
        answers += 1
    check("a log that nobody reads does not stop the service", answers == 200, answers)
    os.close(reader)
    os.close(writer)
    p.terminate()
    check("nor its end", p.wait(40) == 0)
    p.stdout.close()


def test_dead_workers_get_no_work():
    """They die, and the master has not noticed yet."""
    with Daemon("--workers", "1") as d:
        crew = workers(d.pid)
        kill(d.pid, sig=signal.SIGSTOP)
        kill(*crew)
        until(lambda: not any(map(is_there, crew)))
        with Wire(d.port) as w:
            w.send(post(FILE))
            until(lambda: in_flight(d) == 1)
            kill(d.pid, sig=signal.SIGCONT)
            a = w.one()
            check("a request waits for a living worker", a and a.status == 200, a)


def test_leaving_early(d):
    """Whoever leaves costs a worker, but not the time for which failed starts are not repeated."""
    rounds, replaced = 25, 0
    for _ in range(rounds):
        until(lambda: len(workers(d.pid)) == 2 and in_flight(d) == 0)
        crew = workers(d.pid)
        kill(*crew, sig=signal.SIGSTOP)
        w = Wire(d.port)
        w.send(post(FILE))
        until(lambda: in_flight(d) == 1)
        reset(w)
        replaced += until(lambda: not all(map(is_there, crew)))
        kill(*crew, sig=signal.SIGCONT)
    check("workers lost to clients that leave are replaced", replaced == rounds, replaced)


def test_half_closed_in_company(d):
    """The library reads before it answers, where other connections are older."""
    for name, body, query in (("", FILE, ""), (" with a long answer", soup(2000), "defects=100000")):
        with Wire(d.port), Wire(d.port, 20) as w:
            until(lambda: len(workers(d.pid)) == 2)
            crew = workers(d.pid)
            kill(*crew, sig=signal.SIGSTOP)
            w.send(post(body, query) * 2)
            until(lambda: in_flight(d) == 1)
            w.finish()
            time.sleep(0.1)
            kill(*crew, sig=signal.SIGCONT)
            got = [a.status for a in w.read(2)]
            # libmicrohttpd 1.0 ends the connection with the first of them
            check("who closes its side gets its answers" + name,
                  got == [200, 200] or (LIBRARY >= 1 and got == [200]), got)


def soup(n):
    """Triangles that have nothing to do with each other: three open edges each."""
    r = random.Random(1)
    return stl([[[r.random() for _ in range(3)] for _ in range(3)] for _ in range(n)])


def test_answers_that_nobody_reads():
    mesh = soup(9000)  # 0.4 MB, some 6 MB of defects
    with Daemon("--workers", "1", "--memory", "64MB") as d:
        wires, statuses = [], []
        for _ in range(8):
            s = socket.socket()
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            s.settimeout(20)
            s.connect(("127.0.0.1", d.port))
            s.sendall(post(mesh, "defects=100000"))
            statuses.append(s.recv(12)[9:])
            wires.append(s)
        check("large answers that nobody reads are within the budget",
              statuses[0] == b"200" and statuses[-1] == b"429", statuses)
        a = d.post(FILE)
        check("and leave room for uploads", a.status == 200, a)
        for s in wires:
            s.close()
        check("what they took comes back", until(lambda: in_flight(d) == 0, 5) and
              b"waiting bodies: 0 of" in d.get("/readyz?verbose").body)


def test_a_limit_of_connections():
    """Fewer of them where there is little memory: every head may take 64 kB."""
    with Daemon("--workers", "1", "--memory", "64MB") as d:
        held = [d.connect() for _ in range(300)]
        a = ask(d.port, request())
        check("too many connections are turned away", a and a.status == 503, a)
        for s in held:
            s.close()
        check("for as long as it lasts", until(lambda: (a := ask(d.port, request()))
                                               and a.status == 200, 5))


def resident(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as f:
        return next(1024 * int(line.split()[1]) for line in f if line.startswith("VmRSS"))


def test_long_heads():
    """Half of the 16 MB for waiting bodies may go to heads that do not end."""
    with Daemon("--workers", "1", "--memory", "64MB") as d:
        for _ in range(3):  # what the first requests take once
            d.get("/livez")
        before, held = resident(front(d.pid)), []
        for _ in range(250):
            held.append(Wire(d.port))
            held[-1].send(b"GET /livez?" + b"a" * 60000 + b" HTTP/1.1\r\nHost: x\r\nX: "
                          + b"b" * 50000)
        grown = []
        until(lambda: grown.append(resident(front(d.pid)) - before), 1)
        check("heads without end stay within their share", SANITIZED or max(grown) < 12 << 20,
              max(grown))
        for w in held:
            w.socket.close()
        check("and are forgotten", until(lambda: (a := ask(d.port, request()))
                                         and a.status == 200, 5))


with Daemon("--workers", "1", "--log-format", "json") as daemon:
    test_log(daemon)
    test_leaving_early(daemon)
    test_half_closed_in_company(daemon)
    test_many_parameters(daemon)
test_limit_at_a_full_ring()
test_far_beyond_the_limit()
test_log_that_nobody_reads()
test_dead_workers_get_no_work()
test_answers_that_nobody_reads()
test_a_limit_of_connections()
test_long_heads()
finish()
