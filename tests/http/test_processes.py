#!/usr/bin/env python3
"""What becomes of requests when workers, the front, clients or the whole daemon end."""
import threading

from contract import *
from family import *
from harness import *
from wire import *

BOX = box((0, 0, 0), (40, 30, 20))
FILE = stl(BOX)
BIG = stl(BOX * 20000)  # 12 MB
POST = b"POST /v1/mass-properties?unit=mm HTTP/1.1\r\nHost: x\r\nContent-Length: %d\r\n\r\n"


def ready(d, count):
    """All workers are there and nothing is at work but the question itself."""
    text = f"workers: {count} of {count}\nqueue: 0 small, 0 large\nin flight: 1\n"
    return lambda: text in d.get("/readyz?verbose", timeout=5).body.decode()


def in_flight(d, count):
    return lambda: f"in flight: {count + 1}\n" in d.get("/readyz?verbose", timeout=5).body.decode()


class Call(threading.Thread):
    """A request in a thread; .answer behind join()."""

    def __init__(self, d, data):
        super().__init__()
        self.port, self.bytes, self.answer = d.port, data, None
        self.start()

    def run(self):
        self.answer = ask(self.port, self.bytes, 60)


def lost(a):
    """Either the connection ended, or the answer says whose fault it was."""
    return a is None or not problem_faults(a, 503, "worker_lost")


def test_kill_in_an_upload(d):
    """Kill the worker that reads a large body, half of which has come."""
    crew = workers(d.pid)
    before = [cpu(p) for p in crew]
    with Wire(d.port, 30) as w:
        w.send(POST % len(BIG) + BIG[:len(BIG) // 2])
        until(lambda: any(cpu(p) > b for p, b in zip(crew, before)), 5)
        victim = crew[0]  # a fresh daemon gives the first job to its first worker
        kill(victim)
        ok = w.send(BIG[len(BIG) // 2:])
        a = w.one() if ok else None
    check("who lost its worker in the upload is told so", lost(a), a)
    check("a replacement comes", until(ready(d, 3)) and len(workers(d.pid)) == 3
          and victim not in workers(d.pid), d.log())
    a = ask(d.port, post(BIG))
    check("it takes the same file", a and a.status == 200 and a.json["bodies"], a)


def test_kill_at_work(d):
    """Stopped workers are at work for as long as one likes."""
    crew = workers(d.pid)
    kill(*crew, sig=signal.SIGSTOP)
    calls = []
    for i in range(len(crew)):
        calls.append(Call(d, post(FILE, "unit=mm")))
        until(in_flight(d, i + 1))
    kill(crew[1])
    kill(crew[0], crew[2], sig=signal.SIGCONT)
    for c in calls:
        c.join()
    hit = [c.answer for c in calls if not (c.answer and c.answer.status == 200)]
    check("one killed worker costs one request", len(hit) == 1 and lost(hit[0])
          and hit[0] is not None, [str(c.answer) for c in calls])
    check("its place is filled", until(ready(d, 3)), d.get("/readyz?verbose"))


def test_kill_with_a_line(d):
    """Small requests stand in line with a worker: its end costs the first of them, no other."""
    sides, done, wrong, stop = range(1, 9), [], [], threading.Event()

    def client(side):
        data = post(stl(box((0, 0, 0), (side, side, side))), "unit=mm")
        w = Wire(d.port, 30)
        while not stop.is_set():
            w.send(data)
            a = w.one()
            if a and a.status == 200 and a.json["properties"]["volume"] == side**3:
                done.append(side)
            else:
                wrong.append(a)
                w.socket.close()
                w = Wire(d.port, 30)
        w.socket.close()

    threads = [threading.Thread(target=client, args=(s,)) for s in sides]
    for t in threads:
        t.start()
    kills = 0
    for i in range(12):
        before = len(done)
        until(lambda: len(done) > before + 50 and workers(d.pid))
        crew = workers(d.pid)
        kill(crew[i % len(crew)])
        kills += 1
    stop.set()
    for t in threads:
        t.join()
    check("under load each killed worker costs one request at most", len(wrong) <= kills,
          f"{len(wrong)} of {kills}")
    check("and it is told why", all(lost(a) and a is not None for a in wrong),
          [str(a) for a in wrong])
    check("everybody was served all the time", set(done) == set(sides), len(done))
    check("the crew is complete", until(ready(d, 3)), d.get("/readyz?verbose"))


def test_line_behind_a_stopped_worker(d):
    """Who stands behind one that takes its time goes to another worker."""
    crew = workers(d.pid)
    kill(crew[2], sig=signal.SIGSTOP)
    calls = [Call(d, post(FILE, "unit=mm")) for _ in range(24)]
    served = until(lambda: sum(not c.is_alive() for c in calls) >= 23, 10)
    check("one worker that hangs keeps one request", served,
          sum(not c.is_alive() for c in calls))
    kill(crew[2], sig=signal.SIGCONT)
    for c in calls:
        c.join()
    check("all are served in the end", all(c.answer and c.answer.status == 200 for c in calls),
          [str(c.answer) for c in calls])


def test_large_answers_of_a_line():
    """The front hears late of several answers, each of which lies in a file, at one length."""
    sides, answers = range(1, 9), {}

    def square(side):
        corners = f"v 0 0 0\nv {side} 0 0\nv {side} {side} 0\nv 0 {side} 0\n"
        answers[side] = ask(d.port, request("POST", "/v1/mesh?unit=mm", ["Content-Type: model/obj"],
                                            (corners + "f 1 2 3 4\n" * 3000).encode()), 60)

    def own(side, a):
        facet = struct.unpack("<9f", a.body[96:132]) if a and a.status == 200 else ()
        return set(facet) == {0.0, float(side)}

    with Daemon("--workers", "1") as d:
        polls, crew = front(d.pid), workers(d.pid)
        kill(*crew, sig=signal.SIGSTOP)
        threads = [threading.Thread(target=square, args=(s,)) for s in sides]
        kill(polls, sig=signal.SIGSTOP)
        for t in threads:
            t.start()
        time.sleep(0.2)
        kill(polls, sig=signal.SIGCONT)
        time.sleep(0.004)  # enough to hand them out, less than a turn
        kill(polls, sig=signal.SIGSTOP)
        before = [cpu(p) for p in crew]
        kill(*crew, sig=signal.SIGCONT)
        until(lambda: all(cpu(p) >= b + 15 for p, b in zip(crew, before)), 3)
        kill(polls, sig=signal.SIGCONT)
        for t in threads:
            t.join()
        check("each has its own answer", all(own(s, answers[s]) for s in sides),
              [str(answers[s])[:200] for s in sides if not own(s, answers[s])])


def test_kill_idle(d):
    crew = workers(d.pid)
    kill(*crew)
    a = ask(d.port, post(FILE), 20)  # may meet one that is dead and not yet missed
    check("killed in their sleep: served or told to come again",
          a and (a.status == 200 or lost(a)), a)
    check("all come back", until(ready(d, 3)) and not set(crew) & set(workers(d.pid)), d.log())
    for _ in range(5):
        kill(*workers(d.pid))
        time.sleep(0.02)
    check("again and again", until(ready(d, 3)) and ask(d.port, post(FILE)).status == 200, d.log())


def test_crash(d):
    """A signal of its own making: the file is to blame."""
    crew = workers(d.pid)
    kill(*crew, sig=signal.SIGSTOP)
    call = Call(d, post(FILE, "unit=mm"))
    until(in_flight(d, 1))
    kill(*crew, sig=signal.SIGABRT)
    kill(*crew, sig=signal.SIGCONT)
    call.join()
    a = call.answer
    check("a crash is the file's fault", a and not problem_faults(a, 422, "decoder_crashed"), a)
    check("the crashed are replaced", until(ready(d, 3)), d.get("/readyz?verbose"))


def test_kill_front(d):
    old, crew = front(d.pid), workers(d.pid)
    w = Wire(d.port, 20)
    w.send(POST % len(FILE) + FILE[:100])
    until(in_flight(d, 1))
    kill(old)
    check("the front's end ends its connections", w.ends())
    a = until(lambda: (a := ask(d.port, request(path="/readyz"), 5)) and a.status == 200)
    check("the master brings it back", a and front(d.pid) not in (None, old), d.log())
    check("with all its workers", until(ready(d, 3)) and not set(crew) & set(workers(d.pid)),
          f"{crew} {workers(d.pid)}")
    a = ask(d.port, post(FILE))
    check("work goes on", a and a.status == 200, a)
    check("nobody is left over", until(lambda: len(children(d.pid)) == 4), children(d.pid))


def test_deadline():
    with Daemon("--workers", "1", "--deadline", "200ms") as d:
        crew = workers(d.pid)
        kill(*crew, sig=signal.SIGSTOP)
        a = ask(d.port, post(FILE, "unit=mm"), 20)
        check("a deadline ends a worker that hangs",
              a and not problem_faults(a, 422, "too_expensive"), a)
        check("which is replaced", until(lambda: len(set(workers(d.pid)) - set(crew)) == 1))
        check("and the next file is served", ask(d.port, post(FILE), 20).status == 200)
        kill(*crew, sig=signal.SIGCONT)


def test_clients_that_leave(d):
    settled = ready(d, 3)
    until(settled)
    crew, polls = workers(d.pid), front(d.pid)
    before = len(descriptors(polls))
    for i in range(50):
        with Wire(d.port) as w:
            if i % 5 == 0:
                w.send((POST % len(BIG))[:-1 - i])
            elif i % 5 == 1:
                w.send(POST % len(BIG) + BIG[:300000 + i])
            elif i % 5 == 2:
                w.send(POST % len(BIG) + BIG[:2000000])
            elif i % 5 == 3:
                w.send(POST % len(FILE) + FILE)  # leaves without its answer
            else:
                w.send(POST % len(FILE) + FILE[:-1])
                w.finish()
            if i % 2:  # a reset rather than an end
                w.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    check("50 uploads broken off: all is quiet again", until(settled, 30),
          d.get("/readyz?verbose"))
    check("no descriptor is lost", until(lambda: len(descriptors(polls)) <= before, 5),
          f"{before} {descriptors(polls)}")
    check("no zombie stays", not [p for p in children(d.pid) if is_zombie(p)])
    check("the front is the same, the crew complete", front(d.pid) == polls
          and len(workers(d.pid)) == len(crew))
    a = ask(d.port, post(FILE))
    check("and works", a and a.status == 200, a)


def test_half_closed(d):
    answered = 0
    for _ in range(300):  # now and then the end meets the answer half-way
        with Wire(d.port) as w:
            w.send(POST % len(FILE) + FILE)
            w.finish()
            a = w.one()
            answered += a is not None and a.status == 200 and a.json["bodies"] != []
    check("who closes its side behind the body gets its answer", answered == 300, answered)
    with Wire(d.port, 20) as w:
        w.send(POST % len(BIG) + BIG)
        w.finish()
        a = w.one()
        check("with a large body too", a and a.status == 200, a)
    with Wire(d.port, 8) as w:
        w.send(POST % len(FILE) + FILE[:300])
        w.finish()
        check("half a body and an end: the connection ends", w.ends(), w.data)
    with Wire(d.port, 8) as w:
        w.send(POST % len(BIG) + BIG[:len(BIG) // 2])
        w.finish()
        check("half a large body and an end: likewise", w.ends(), w.data)
    with Wire(d.port, 8) as w:
        w.send(b"GET /livez HTTP/1.1\r\nHost:")
        w.finish()
        check("half a head and an end: likewise", w.ends(), w.data)
    check("no worker is held by them", until(ready(d, 3)), d.get("/readyz?verbose"))


def refused(port):
    try:
        socket.create_connection(("127.0.0.1", port), 2).close()
        return False
    except ConnectionRefusedError:
        return True


def test_drain():
    with Daemon("--workers", "1") as d, Wire(d.port, 20) as w, Wire(d.port, 20) as idle:
        idle.send(request())
        idle.one()
        crew = workers(d.pid)
        kill(*crew, sig=signal.SIGSTOP)
        w.send(POST % len(FILE) + FILE)
        until(in_flight(d, 1))
        d.process.send_signal(signal.SIGTERM)
        check("SIGTERM: idle connections are closed", idle.ends())
        check("new connections are refused", until(lambda: refused(d.port), 3))
        check("the daemon waits for its work", d.process.poll() is None)
        kill(*crew, sig=signal.SIGCONT)
        a = w.one()
        check("a request in flight is finished", a and a.status == 200
              and a.headers.get("connection") == "close", a)
        check("then it ends with 0", d.process.wait(20) == 0, d.log())
    with Daemon("--workers", "1", "--drain-timeout", "300ms") as d, Wire(d.port, 20) as w:
        crew = workers(d.pid)
        kill(*crew, sig=signal.SIGSTOP)
        w.send(POST % len(FILE) + FILE)
        until(in_flight(d, 1))
        d.process.send_signal(signal.SIGTERM)
        check("work that takes longer than the drain time is given up",
              d.process.wait(20) == 0 and w.ends(), d.log())
    with Daemon("--workers", "1") as d:
        crew = workers(d.pid)
        kill(*crew, sig=signal.SIGSTOP)
        calls = []
        for i in range(3):
            calls.append(Call(d, post(FILE)))
            until(in_flight(d, i + 1))
        d.process.send_signal(signal.SIGTERM)
        time.sleep(0.3)
        kill(*crew)
        for c in calls:
            c.join()
        codes = sorted(c.answer.status if c.answer else 0 for c in calls)
        check("workers lost in a drain are replaced for those who wait", codes == [200, 503, 503],
              codes)
    with Daemon("--workers", "1") as d, Wire(d.port, 20) as w:
        w.send(POST % len(BIG) + BIG[:3000000])
        until(in_flight(d, 1))
        d.process.send_signal(signal.SIGTERM)
        time.sleep(0.3)
        w.send(BIG[3000000:])
        a = w.one()
        check("an upload in flight may end", a and a.status == 200, a)
    with Daemon("--workers", "1", expect_exit=None) as d:
        crew = children(d.pid)
        d.process.kill()
        d.process.wait(10)
        check("nobody survives the master", until(lambda: not any(map(is_there, crew)), 10))


with Daemon("--workers", "2") as daemon:
    test_kill_in_an_upload(daemon)
    test_kill_at_work(daemon)
    test_kill_with_a_line(daemon)
    test_line_behind_a_stopped_worker(daemon)
    test_kill_idle(daemon)
    test_crash(daemon)
    test_clients_that_leave(daemon)
    test_half_closed(daemon)
    test_kill_front(daemon)
test_large_answers_of_a_line()
test_deadline()
test_drain()
finish()
