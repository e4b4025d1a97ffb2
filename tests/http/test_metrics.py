"""/metrics: what promtool takes, and counters that count."""
import re
import shutil
import subprocess

from harness import Daemon, box, check, finish, stl


def read(d):
    """{(name, labels): value} of all samples."""
    text = d.get("/metrics").body.decode()
    lines = [line.rsplit(" ", 1) for line in text.splitlines() if not line.startswith("#")]
    return {name: float(value) for name, value in lines}, text


def requests(samples, status, form):
    return samples.get(f'masspropd_requests_total{{status="{status}",format="{form}"}}', 0)


with Daemon("--workers", "1") as d:
    first, text = read(d)
    check("every family says what it is", text.count("# HELP") == text.count("# TYPE") > 8, text)
    check("all workers are there", first["masspropd_workers"] == 2, text)
    body = stl(box((0, 0, 0), (1, 2, 3)))
    for _ in range(3):
        d.post(body, query="unit=mm")
    d.post(b"solid", query="unit=mm")
    d.post(body, query="nonsense=1")
    d.get("/nowhere")
    now, text = read(d)
    check("good answers are counted by format", requests(now, 200, "stl-binary") == 3, text)
    check("so are bad files", requests(now, 422, "unknown") + requests(now, 422, "stl-ascii") == 1,
          text)
    check("and refusals", requests(now, 400, "unknown") == 1, text)
    check("and paths that are not there", requests(now, 404, "") == 1, text)
    check("bytes received", now["masspropd_received_bytes_total"] >= 3 * len(body), text)
    check("bytes sent", now["masspropd_sent_bytes_total"] > 3000, text)
    check("triangles", now["masspropd_triangles_total"] == 36, text)
    for stage in ("receive", "queue", "decode", "analyse"):
        count = now[f'masspropd_stage_seconds_count{{stage="{stage}"}}']
        buckets = [v for k, v in now.items()
                   if re.match(rf'masspropd_stage_seconds_bucket\{{stage="{stage}"', k)]
        check(f"the histogram of {stage} is whole",
              count == 4 and buckets == sorted(buckets) and buckets[-1] == count, text)
    check("nothing waits, nobody works",
          now['masspropd_queue_depth{class="small"}'] == now["masspropd_workers_busy"] == 0, text)
    done = subprocess.run([shutil.which("promtool") or "promtool", "check", "metrics"],
                          input=text.encode(), capture_output=True)
    check("promtool accepts it", done.returncode == 0, done.stdout + done.stderr)
finish()
