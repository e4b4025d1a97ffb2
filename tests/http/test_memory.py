#!/usr/bin/env python3
"""What a worker does with memory between jobs."""
import re
import struct

from family import *
from harness import *
from wire import *

FACETS = stl(box((0, 0, 0), (40, 30, 20)))[84:]
COPIES = 200000
MEGABYTE = 1 << 20


def limit(pid, what):
    with open(f"/proc/{pid}/limits", encoding="ascii") as f:
        return next(re.split(r"  +", line)[1] for line in f if line.startswith(what))


def test_limits_of_workers():
    """Files in memory are none of the data that RLIMIT_DATA counts."""
    with Daemon("--workers", "1", "--memory", "128MB") as d:
        for worker, most in zip(workers(d.pid), (80_000_000, 16_000_000)):
            seen = [int(limit(worker, w)) for w in ("Max data size", "Max file size")]
            check("a worker has its share of the memory, for files too", seen == [most, most], seen)
            count = int(limit(worker, "Max open files"))
            check("and few descriptors", count <= 64, count)


def memory(pid, what):
    """VmRSS, VmHWM or VmData, in bytes."""
    with open(f"/proc/{pid}/status", encoding="ascii") as f:
        return next(int(line.split()[1]) << 10 for line in f if line.startswith(what + ":"))


def test_a_large_job_leaves_no_large_worker(d):
    worker = workers(d.pid)[0]
    a = d.post(bytes(80) + struct.pack("<I", 12 * COPIES) + FACETS * COPIES)
    check("a large mesh is answered", a.status == 200, a)
    check("it took memory", memory(worker, "VmHWM") > 96 * MEGABYTE, memory(worker, "VmHWM"))
    check("a worker that rests gives memory back",
          SANITIZED or until(lambda: memory(worker, "VmRSS") < 80 * MEGABYTE, 20),
          memory(worker, "VmRSS"))
    a = d.post(bytes(80) + struct.pack("<I", 12 * COPIES) + FACETS * COPIES)
    check("another one is answered", a.status == 200, a)
    middle = bytes(80) + struct.pack("<I", 12 * 500) + FACETS * 500  # has no lane of its own

    def small():
        return d.post(middle).status == 200 and memory(worker, "VmRSS") < 80 * MEGABYTE

    check("a worker that has small jobs only gives it back, too",
          SANITIZED or until(small, 20), memory(worker, "VmRSS"))
    a = d.post(stl(box((0, 0, 0), (40, 30, 20))))
    check("the same worker goes on", a.status == 200 and workers(d.pid)[0] == worker, a)


def test_what_one_job_had_is_there_for_the_next():
    """Holes in the heap count against the limit: with little memory large tables leave none."""
    with Daemon("--workers", "1", "--memory", "1GB") as d:
        worker = workers(d.pid)[0]
        before = memory(worker, "VmData")
        for copies in (300000, 400000):
            a = d.post(bytes(80) + struct.pack("<I", 12 * copies) + FACETS * copies)
            check("a large mesh is answered", a.status == 200, a)
            check("it took memory", memory(worker, "VmHWM") > 12 * 12 * copies)
            check("and none of its large tables is left",
                  until(lambda: memory(worker, "VmData") < before + 80 * MEGABYTE, 1),
                  memory(worker, "VmData"))


with Daemon("--workers", "1") as daemon:
    test_a_large_job_leaves_no_large_worker(daemon)
if not SANITIZED:  # their runtime needs more than any limit
    test_limits_of_workers()
    test_what_one_job_had_is_there_for_the_next()
finish()
