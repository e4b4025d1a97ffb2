"""What `make bench` measures with: servers and their process trees, clients, other programs."""
import json
import os
import re
import resource
import socket
import statistics
import struct
import subprocess
import threading
import time

TICK = os.sysconf("SC_CLK_TCK")


def read(path):
    try:
        with open(path, "rb") as f:
            return f.read()
    except OSError:  # the process has gone
        return b""


def tree(root):
    """${root} and all its descendants that live."""
    parent = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            stat = read(f"/proc/{name}/stat").rpartition(b")")[2].split()
            if stat:
                parent[int(name)] = int(stat[1])
    found = [root]
    for pid in found:
        found += [p for p, up in parent.items() if up == pid]
    return found


class Server:
    """A program whose first line says where it serves, in a with statement."""

    def __init__(self, *command):
        self.command = [str(c) for c in command]

    def __enter__(self):
        env = {k: v for k, v in os.environ.items() if not k.startswith("MASSPROPD_")}
        self.process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL, env=env,
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        line = self.process.stdout.readline().decode()
        found = re.fullmatch(r"http://(.+):(\d+)/?\s*", line)
        if not found:
            self.process.kill()
            raise RuntimeError(f"{self.command}: first line {line!r}")
        self.host, self.port = found.group(1), int(found.group(2))
        self.url = f"http://{self.host}:{self.port}/v1/mass-properties"
        self.pids = tree(self.process.pid)
        for _ in range(200):  # until its workers are there
            time.sleep(0.01)
            before, self.pids = self.pids, tree(self.process.pid)
            if len(before) == len(self.pids) > 1 or "discard" in self.command[0]:
                break
        time.sleep(0.1)
        self.idle = self.memory("VmRSS")
        return self

    def __exit__(self, *_):
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()

    def memory(self, what):
        """Bytes of all processes: VmRSS now, VmHWM the peaks of each so far."""
        total = 0
        for pid in tree(self.process.pid):
            found = re.search(rb"%s:\s+(\d+) kB" % what.encode(), read(f"/proc/{pid}/status"))
            total += int(found.group(1)) * 1024 if found else 0
        return total

    def peak(self):
        """Bytes above what the idle server had, each process at its own peak."""
        return self.memory("VmHWM") - self.idle

    def cpu(self):
        """Seconds of user and system time of all its processes so far, dead ones included."""
        total = 0
        for pid in tree(self.process.pid):
            stat = read(f"/proc/{pid}/stat").rpartition(b")")[2].split()
            # utime, stime, and cutime, cstime of children that were waited for
            total += sum(int(n) for n in stat[11:15]) if stat else 0
        return total / TICK

    def connect(self):
        s = socket.create_connection((self.host, self.port), 10)
        s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        s.settimeout(None)  # else sendfile() does not wait either
        for way in (socket.SO_RCVTIMEO, socket.SO_SNDTIMEO):
            s.setsockopt(socket.SOL_SOCKET, way, struct.pack("ll", 900, 0))
        return s


class Lost(Exception):
    """The server did not answer."""


def answer(s):
    """Status and body of the answer that comes over ${s}; it has a Content-Length."""
    got = b""
    while b"\r\n\r\n" not in got:
        more = s.recv(1 << 16)
        if not more:
            raise Lost
        got += more
    head, _, body = got.partition(b"\r\n\r\n")
    length = int(re.search(rb"(?i)\r\ncontent-length: *(\d+)", head).group(1))
    while len(body) < length:
        more = s.recv(1 << 20)
        if not more:
            raise Lost
        body += more
    return int(head.split(None, 2)[1]), body


def head(size, query=""):
    return (f"POST /v1/mass-properties{query} HTTP/1.1\r\nHost: bench\r\n"
            f"Content-Type: application/octet-stream\r\nContent-Length: {size}\r\n\r\n").encode()


def post(server, path, query=""):
    """Send a file as fast as the server takes it; seconds from connecting to the answer's end,
    seconds of the server's CPU, status, body."""
    with open(path, "rb") as f:
        size, sent = os.fstat(f.fileno()).st_size, 0
        cpu, start = server.cpu(), time.perf_counter()
        with server.connect() as s:
            s.sendall(head(size, query))
            while sent < size:
                sent += os.sendfile(s.fileno(), f.fileno(), sent, 1 << 20)
            status, body = answer(s)
        wall = time.perf_counter() - start
        return wall, server.cpu() - cpu, status, body


def run(*command):
    """Seconds of CPU that a program took, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(c) for c in command], capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime,
            done.stdout.decode("utf-8", "replace"))


class Uploads:
    """Clients that send a file again and again until the with statement ends."""

    def __init__(self, server, path, clients):
        self.server, self.path, self.stop = server, path, threading.Event()
        self.threads = [threading.Thread(target=self.send) for _ in range(clients)]
        self.answers, self.sockets = [], set()

    def send(self):
        try:
            while not self.stop.is_set():
                with open(self.path, "rb") as f, self.server.connect() as s:
                    self.sockets.add(s)
                    size, sent = os.fstat(f.fileno()).st_size, 0
                    s.sendall(head(size))
                    while sent < size and not self.stop.is_set():
                        sent += os.sendfile(s.fileno(), f.fileno(), sent, 1 << 20)
                    self.answers.append(answer(s)[0])
                    self.sockets.discard(s)
        except (OSError, Lost):
            if not self.stop.is_set():
                self.answers.append(0)

    def __enter__(self):
        for t in self.threads:
            t.start()
        return self

    def __exit__(self, *_):
        self.stop.set()
        for s in list(self.sockets):
            try:
                s.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
        for t in self.threads:
            t.join()


def small_requests(server, path, seconds):
    """Latencies of one client with one connection, and how many answers were not 200."""
    body, took, bad = read(path), [], 0
    end = time.perf_counter() + seconds
    with server.connect() as s:
        while time.perf_counter() < end:
            start = time.perf_counter()
            s.sendall(head(len(body)) + body)
            status, _ = answer(s)
            took.append(time.perf_counter() - start)
            bad += status != 200
            time.sleep(0.005)
    return took, bad


WRK_SCRIPT = """
local f = io.open("%s", "rb")
wrk.method, wrk.body = "POST", f:read("*a")
wrk.headers["Content-Type"] = "application/octet-stream"
"""


def wrk(server, path, connections, seconds, script):
    """Requests a second of keep-alive connections, and the server's CPU seconds a request."""
    with open(script, "w", encoding="utf-8") as f:
        f.write(WRK_SCRIPT % path)
    cpu = server.cpu()
    _, text = run("wrk", "-t1", f"-c{connections}", f"-d{seconds}s", "-s", script, server.url)
    cpu = server.cpu() - cpu
    if "Non-2xx" in text or "Socket errors" in text:
        raise RuntimeError(text)
    requests = int(re.search(r"(\d+) requests in", text).group(1))
    return float(re.search(r"Requests/sec:\s*([\d.]+)", text).group(1)), cpu / requests


# ------------------------------------------------------------------------------- instructions


def callgrind(out, toggle, *command):
    """Instructions of ${command} by source file or, without debug information, by object;
    ${toggle}: only within functions of that name."""
    flags = ["--toggle-collect=" + toggle] if toggle else []
    run("valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", *flags, *command)
    cost, name, at = {}, {}, None
    # The format: valgrind's manual, cl-format.  Names are compressed as (number) name.
    for line in open(out, encoding="utf-8", errors="replace"):
        found = re.match(r"(ob|fl|fi|fe|fn|cob|cfi|cfl|cfn|calls|jump|jcnd)=\s*(?:\((\d+)\))? ?(.*)",
                         line)
        if found:
            kind, number, text = found.groups()
            kind, space = kind.lstrip("c") if kind != "calls" else kind, None
            space = "file" if kind in ("fl", "fi", "fe") else kind
            if number is not None and text:
                name[space, number] = text
            if line.startswith(("fl=", "fi=", "fe=")):
                at = name.get((space, number), text)
            elif line.startswith("ob="):
                owner = name.get((space, number), text)
            skip = kind == "calls"
            continue
        words = line.split()
        if len(words) == 2 and re.match(r"[0-9+*-]", line):
            if not skip:  # behind calls= stands the cost of the callee
                key = at if at and at != "???" else owner
                cost[key] = cost.get(key, 0) + int(words[1])
            skip = False
    return cost


def median(values):
    return statistics.median(values)


def as_json(body):
    try:
        return json.loads(body)
    except ValueError:
        return {}
