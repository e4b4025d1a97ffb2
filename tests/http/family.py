"""The processes of a daemon, seen through /proc."""
import os
import re
import signal
import time


def _stat(pid):
    """Fields of /proc/PID/stat behind the name: [0] state, [1] parent, [19] start; None: gone."""
    try:
        with open(f"/proc/{pid}/stat", encoding="latin-1") as f:
            return f.read().rpartition(")")[2].split()
    except OSError:
        return None


def children(pid):
    """Pids of the children, oldest first, zombies among them."""
    found = []
    for name in os.listdir("/proc"):
        stat = _stat(name) if name.isdigit() else None
        if stat and int(stat[1]) == pid:
            found.append((int(stat[19]), int(name)))
    return [p for _, p in sorted(found)]


def is_zombie(pid):
    stat = _stat(pid)
    return bool(stat) and stat[0] == "Z"


def is_there(pid):
    stat = _stat(pid)
    return bool(stat) and stat[0] not in "ZX"


def cpu(pid):
    """Ticks of work so far."""
    stat = _stat(pid)
    return int(stat[11]) + int(stat[12]) if stat else 0


def descriptors(pid):
    """What its descriptors are, e.g. 'socket:[123]'."""
    out = []
    try:
        for fd in os.listdir(f"/proc/{pid}/fd"):
            try:
                out.append(os.readlink(f"/proc/{pid}/fd/{fd}"))
            except OSError:
                pass
    except OSError:
        pass
    return out


def memory(pid):
    """Bytes of the master and its children: pages, shared ones in proportion, and what lies in
    anonymous files, which no process has mapped."""
    total, files = 0, {}
    for p in [pid, *children(pid)]:
        try:
            with open(f"/proc/{p}/smaps_rollup", encoding="ascii") as f:
                total += 1024 * int(re.search(r"^Pss: +(\d+)", f.read(), re.M)[1])
            for fd in os.listdir(f"/proc/{p}/fd"):
                path = f"/proc/{p}/fd/{fd}"
                if os.readlink(path).startswith("/memfd:"):
                    held = os.stat(path)
                    files[held.st_ino] = 512 * held.st_blocks
        except (OSError, TypeError):  # it has just ended, or closed it
            pass
    return total + sum(files.values())


def front(master):
    """The one child that polls."""
    for pid in children(master):
        if any("eventpoll" in d for d in descriptors(pid)):
            return pid
    return None


def workers(master):
    """All others, in the order of their start: the last of a fresh daemon is the small lane."""
    polls = front(master)
    return [p for p in children(master) if p != polls and is_there(p)]


def kill(*pids, sig=signal.SIGKILL):
    for pid in pids:
        try:
            os.kill(pid, sig)
        except ProcessLookupError:
            pass


def until(condition, seconds=20):
    """Wait for something; False where it does not come about."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True
