#!/usr/bin/env python3
"""What the system does to us: processes killed at random under load, forks that fail, tables of
descriptors and memory that are full."""
# tests/run: alone
import random
import resource
import threading

from contract import *
from family import *
from harness import *
from wire import *

SOMEBODY = 54321  # root's forks never fail: a daemon that root tests runs as nobody in particular


def part(i):
    return stl(box((0, 0, 0), (1, 2, 3 + i)))


def ready(d, count):
    return lambda: f"workers: {count} of {count}".encode() in d.get("/readyz?verbose").body


def settled(d, before):
    polls = front(d.pid)
    return lambda: (len(descriptors(polls)) <= before and not [p for p in children(d.pid)
                                                               if is_zombie(p)])


class Load:
    """${clients} threads that post parts of known volumes until told to stop."""

    def __init__(self, d, clients):
        self.d, self.over = d, threading.Event()
        self.right, self.lost, self.wrong, self.kept = 0, 0, [], threading.Lock()
        self.threads = [threading.Thread(target=self.run, args=(c,)) for c in range(clients)]

    def run(self, c):
        i = c
        while not self.over.is_set():
            i += 8
            large = part(i) if i % 5 else part(i)[:80] + struct.pack("<I", 12000) + part(i)[84:] * 1000
            a = ask(self.d.port, post(large), 60)
            with self.kept:
                self.count(a, i, 1 if i % 5 else 1000)

    def count(self, a, i, times):
        if a is not None and a.status == 200 and a.json["properties"]["volume"] == times * 2 * (
                3 + i):
            self.right += 1
        elif a is not None and not problem_faults(a, 503, "worker_lost"):
            self.lost += 1
        elif a is None or a.status != 429 or problem_faults(a, 429, "queue_full"):
            self.wrong.append(f"{a}"[:300])

    def __enter__(self):
        for t in self.threads:
            t.start()
        return self

    def __exit__(self, *_):
        self.over.set()
        for t in self.threads:
            t.join()


def test_random_kills(d):
    rng, killed, quiet = random.Random(7), 0, len(descriptors(front(d.pid)))
    with Load(d, 8) as load:
        end = time.monotonic() + 6
        while time.monotonic() < end:
            time.sleep(rng.uniform(0.005, 0.06))
            crew = workers(d.pid)
            if crew:
                kill(rng.choice(crew))
                killed += 1
    check("workers killed at random: every answer is right, or tells of the loss", not load.wrong,
          "\n".join(load.wrong[:10]))
    check("every loss is one kill's", 0 < load.lost <= killed, f"{load.lost} of {killed}")
    check("most go on", load.right > load.lost, f"{load.right} right, {load.lost} lost")
    check("the crew is complete again", until(ready(d, 3)), d.get("/readyz?verbose"))
    check("no descriptor and no zombie stays", until(settled(d, quiet), 5),
          descriptors(front(d.pid)))
    print(f"# {killed} kills, {load.right} right, {load.lost} lost")


def as_somebody():
    if os.geteuid() == 0:
        os.setgroups([])
        os.setgid(SOMEBODY)
        os.setuid(SOMEBODY)


def let_fork(pid, processes):
    """Limit the processes of the daemon's user, softly; only that user may."""
    with open(f"/proc/{pid}/limits", encoding="ascii") as f:
        hard = re.search(r"Max processes +\w+ +(\w+)", f.read())[1]
    subprocess.run(["prlimit", "--pid", str(pid), f"--nproc={hard if processes < 0 else processes}:"],
                   check=True, preexec_fn=as_somebody, timeout=20)


class MortalDaemon(Daemon):
    """One whose forks can be made to fail."""

    def __init__(self, *flags):
        super().__init__(*flags, ready=False)

    def __enter__(self):
        make = subprocess.Popen
        try:
            subprocess.Popen = lambda *a, **k: make(*a, preexec_fn=as_somebody, **k)
            super().__enter__()
        finally:
            subprocess.Popen = make
        self.wait_ready()
        return self


def test_failed_forks():
    with MortalDaemon("--workers", "2") as d:
        let_fork(d.pid, 1)
        crew = workers(d.pid)
        kill(crew[0])
        check("a fork that fails is written down", until(lambda: "cannot fork worker" in d.log()),
              d.log())
        got = [ask(d.port, post(part(i)), 20) for i in range(20)]
        check("the others serve", all(a and a.status == 200 for a in got),
              [str(a) for a in got if not a or a.status != 200][:2])
        kill(*crew[1:])
        a = ask(d.port, request(path="/livez"))
        check("without any worker the front lives", a and a.status == 200, a)
        a = ask(d.port, request(path="/readyz"))
        check("and is not ready", until(lambda: ask(d.port, request(path="/readyz")).status == 503),
              a)
        with Wire(d.port, 20) as w:
            w.send(post(part(1)))
            let_fork(d.pid, -1)
            a = w.one()
            check("who waits is served when forks work again", a and a.status == 200, a)
        check("all are back", until(ready(d, 3)), d.get("/readyz?verbose"))
        let_fork(d.pid, 1)
        kill(front(d.pid))
        check("a front that cannot be forked is written down",
              until(lambda: "cannot fork the front" in d.log()), d.log())
        let_fork(d.pid, -1)
        check("and comes when it can", until(lambda: (a := ask(d.port, post(part(2)), 5)) and
                                             a.status == 200), d.log())


def test_full_table(d):
    polls = front(d.pid)
    before, free = len(descriptors(polls)), resource.prlimit(polls, resource.RLIMIT_NOFILE)
    highest = max(int(fd) for fd in os.listdir(f"/proc/{polls}/fd"))
    resource.prlimit(polls, resource.RLIMIT_NOFILE, (highest + 12, free[1]))
    held = [d.connect() for _ in range(60)]
    a = ask(d.port, request())
    check("a full table of descriptors: turned away at once", a and a.status == 503 and
          "retry-after" in a.headers, a)
    with Wire(d.port, 10) as w:
        w.socket.close()
        w.socket = held[0]
        w.send(post(part(1)))
        a = w.one()
        check("those who are in are served", a and a.status == 200, a)
    big = part(1)[:80] + struct.pack("<I", 120000) + part(1)[84:] * 10000
    held[1].settimeout(20)
    held[1].sendall(post(big))  # would be spooled to a file or streamed
    a = held[1].recv(12)
    check("a large body too, or refused as the memory is", a[9:] in (b"200", b"429"), a)
    for s in held:
        s.close()
    check("then all is as before", until(settled(d, before), 10), descriptors(polls))
    check("for everybody", until(lambda: (a := ask(d.port, post(part(3)))) and a.status == 200, 5))
    resource.prlimit(polls, resource.RLIMIT_NOFILE, free)
    check("the front is the same", front(d.pid) == polls, d.log())


def test_full_memory(d):
    polls = front(d.pid)
    free = resource.prlimit(polls, resource.RLIMIT_DATA)
    resource.prlimit(polls, resource.RLIMIT_DATA, (1, free[1]))  # nothing more, from now on
    big = part(1)[:80] + struct.pack("<I", 12000) + part(1)[84:] * 1000
    held = []
    for i in range(100):  # whatever they get, it comes in good time
        try:
            s = d.connect(5)
            held.append(s)
            s.sendall(post(big if i % 2 else part(i)))
        except OSError:
            pass
    got = [replies(receive(s)) if i % 10 == 0 else [] for i, s in enumerate(held)]
    statuses = {a.status for answers in got for a in answers}
    ended = len([1 for i in range(0, len(held), 10) if not got[i]])
    check("without memory answers are reports, or ask to come again",
          statuses <= {200, 429, 500, 503}, statuses)
    for s in held:
        s.close()
    resource.prlimit(polls, resource.RLIMIT_DATA, free)
    check("the front lives on", front(d.pid) == polls, d.log()[-2000:])
    check("and serves when there is memory again",
          until(lambda: (a := ask(d.port, post(part(3)))) and a.status == 200, 10), d.log()[-2000:])
    print(f"# statuses while memory was out: {sorted(statuses)}, {ended} of 10 ended")


with Daemon("--workers", "2", "--queue", "64") as daemon:
    check("a crew", until(ready(daemon, 3)))
    test_random_kills(daemon)
    test_full_table(daemon)
    if not SANITIZED:  # these cannot do without memory
        test_full_memory(daemon)
test_failed_forks()
finish()
