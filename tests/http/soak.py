#!/usr/bin/env python3
"""soak.py SECONDS: one daemon under mixed load for so long; is its memory flat, every answer right?

Parts of every format and size, forms, compressed bodies, broken files, clients that leave, that drip,
that do not read, workers killed now and then.  Prints a line a minute and a verdict at the end.
`make soak TIME=1800` runs it.
"""
import gzip
import random
import threading

from contract import *
from family import *
from harness import *
from wire import *

CLIENTS = 6


def obj(mesh):
    places = {}
    faces = ["f " + " ".join(str(places.setdefault(p, len(places) + 1)) for p in t) for t in mesh]
    return "\n".join(["v %r %r %r" % p for p in places] + faces).encode() + b"\n"


def pool():
    """(request, what its answer must be like) in a list to draw from."""
    out = []

    def add(data, wanted, query="", headers=()):
        out.append((post(data, query, headers), wanted))

    def volume_is(v):
        return lambda a: a.status == 200 and near(a.json["properties"]["volume"], v, 1e-9)

    def problem(status):
        return lambda a: a.status == status and a.json["status"] == status

    for i, n in enumerate((4, 8, 16, 40, 90)):
        mesh = torus((0, 0, i), 30, 10, n, n)
        v = volume_is(volume(mesh))
        add(stl_ascii(mesh), v)
        add(obj(mesh), v)
        add(gzip.compress(stl_ascii(mesh)), v, headers=("Content-Encoding: gzip",))
        add(stl_ascii(mesh), v, "precision=exact&density=2700&about=1,2,3&axis=0,1,0")
        add(stl_ascii(mesh)[:-200 * n], problem(422))
        add(stl(mesh)[:-30], problem(422))
    box12 = stl(box((0, 0, 0), (40, 30, 20)))
    for facets in (12, 1200, 60000, 400000):
        data = box12[:80] + struct.pack("<I", facets // 12 * 12) + box12[84:] * (facets // 12)
        add(data, volume_is(24000 * (facets // 12)))
    soup = b"".join(struct.pack("<12fH", 0, 0, 0, i, 0, 0, i, 1, 0, i, 0, 1, 0) for i in range(3000))
    add(box12[:80] + struct.pack("<I", 3000) + soup, lambda a: a.status == 200 and
        a.json["properties"]["volume"] is None, "defects=3000")
    add(b"\0" * 5000, problem(422))
    add(b"v 0 0 0\nv 1 nan 0\nf 1 2 3\n", problem(422))
    add(box12, problem(400), "density=-1")
    add(gzip.compress(bytes(1 << 24)), problem(422), headers=("Content-Encoding: gzip",))
    return out


class Soak:
    def __init__(self, d):
        self.d, self.over, self.lock = d, threading.Event(), threading.Lock()
        self.answers, self.wrong, self.lost, self.kills = 0, [], 0, 0
        self.pool = pool()

    def judge(self, a, wanted):
        with self.lock:
            self.answers += 1
            if a is not None and a.status == 503 and a.json["code"] == "worker_lost":
                self.lost += 1
            elif a is None or not (a.status == 429 or wanted(a)):
                self.wrong.append(str(a)[:300])

    def client(self, seed):
        rng = random.Random(seed)
        while not self.over.is_set():
            data, wanted = rng.choice(self.pool)
            kind = rng.random()
            if kind < 0.8:
                self.judge(ask(self.d.port, data, 60), wanted)
                continue
            with Wire(self.d.port, 60) as w:
                if kind < 0.9:  # leaves anywhere
                    w.send(data[:rng.randrange(len(data))])
                elif kind < 0.95:  # asks and does not wait
                    w.send(data)
                else:  # drips
                    for at in range(0, min(len(data), 40000), 10000):
                        w.send(data[at:at + 10000])
                        time.sleep(0.05)
                    w.send(data[40000:])
                    self.judge(w.one(), wanted)

    def killer(self):
        rng = random.Random(1)
        while not self.over.wait(rng.uniform(2, 8)):
            crew = workers(self.d.pid)
            if crew:
                kill(rng.choice(crew))
                self.kills += 1

    def run(self, seconds):
        threads = [threading.Thread(target=self.client, args=(i,)) for i in range(CLIENTS)]
        threads.append(threading.Thread(target=self.killer))
        for t in threads:
            t.start()
        began, highs = time.monotonic(), []
        window = max(seconds / 30, 5)
        while time.monotonic() - began < seconds:
            high, end = 0, time.monotonic() + window
            while time.monotonic() < end:
                high = max(high, memory(self.d.pid))
                time.sleep(0.5)
            highs.append(high)
            print(f"# {time.monotonic() - began:6.0f} s: {self.answers} answers, {self.lost} lost to "
                  f"{self.kills} kills, {len(self.wrong)} wrong, at most {high >> 20} MiB, front "
                  f"{len(descriptors(front(self.d.pid)))} descriptors", flush=True)
        self.over.set()
        for t in threads:
            t.join()
        return highs


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60
    with Daemon("--workers", "2", "--memory", "2GB", "--log-level", "warn") as d:
        polls = front(d.pid)
        quiet = len(descriptors(polls))
        soak = Soak(d)
        highs = soak.run(seconds)
        third = max(len(highs) // 3, 1)
        first, last = sorted(highs[:third]), sorted(highs[-third:])
        check("every answer is right, or says that its worker was lost", not soak.wrong,
              "\n".join(soak.wrong[:10]))
        check("no more are lost than workers were killed", soak.lost <= soak.kills,
              f"{soak.lost} of {soak.kills}")
        check("memory is flat: the last third's median high is not above the first's by 10 %",
              last[len(last) // 2] < first[len(first) // 2] * 1.1 + (16 << 20), highs)
        check("the front is the one that began, and has its descriptors back",
              front(d.pid) == polls and until(lambda: len(descriptors(polls)) <= quiet, 20),
              descriptors(polls))
        check("nobody is a zombie", not [p for p in children(d.pid) if is_zombie(p)])
        print(f"# {soak.answers} answers in {seconds:.0f} s")
    finish()


main()
