"""What every answer of the service has in common, as checks for the test files beside it."""
import re

from harness import check

REQUEST_ID = re.compile(r"[A-Za-z0-9_.-]{1,64}")
MEMBERS = {"type", "title", "status", "detail", "instance", "code", "retryable", "request_id"}
EXTRAS = {"option", "limit", "actual", "byte", "line"}
RETRYABLE = {"queue_full", "memory_full", "draining", "worker_lost"}


def common_faults(answer):
    """What is missing of the headers that every answer carries."""
    h, faults = answer.headers, []
    if not REQUEST_ID.fullmatch(h.get("x-request-id", "")):
        faults.append("X-Request-Id")
    if not re.search(r"\w+;dur=[0-9.]+", h.get("server-timing", "")):
        faults.append("Server-Timing")
    if h.get("x-content-type-options") != "nosniff":
        faults.append("X-Content-Type-Options")
    if "origin" not in h.get("vary", "").lower():
        faults.append("Vary")
    return faults


def problem_faults(answer, status, code, instance="/v1/mass-properties", **extra):
    """What is wrong with an error; ${extra}: members it must have, True for any value."""
    faults, p = common_faults(answer), answer.json
    if answer.status != status:
        faults.append(f"status {answer.status}, not {status}")
    if answer.headers.get("content-type", "") != "application/problem+json":
        faults.append("Content-Type")
    if not isinstance(p, dict):
        return faults + ["no JSON object"]
    if not MEMBERS <= set(p):
        return faults + [f"members missing: {MEMBERS - set(p)}"]
    if not set(p) <= MEMBERS | EXTRAS:
        faults.append(f"members unheard of: {set(p) - MEMBERS - EXTRAS}")
    if p["code"] != code:
        faults.append(f"code {p['code']}, not {code}")
    if p["status"] != status or p["instance"] != instance:
        faults.append("status or instance")
    if p["retryable"] is not (p["code"] in RETRYABLE):
        faults.append("retryable")
    if p["request_id"] != answer.headers.get("x-request-id"):
        faults.append("request_id is not that of the header")
    for name in ("type", "title", "detail"):
        if not isinstance(p[name], str) or not p[name]:
            faults.append(name)
    if (p["code"] in RETRYABLE) != ("retry-after" in answer.headers):
        faults.append("Retry-After")
    for name, value in extra.items():
        if name not in p or (value is not True and p[name] != value):
            faults.append(f"{name} {p.get(name)}, not {value}")
    return faults


def check_problem(name, answer, status, code, **extra):
    faults = problem_faults(answer, status, code, **extra)
    return check(name, not faults, f"{'; '.join(faults)}\n{answer}")


def check_all(name, cases):
    """One test of many cases: ${cases} yields (what, faults)."""
    faults = [f"{what}: {f}" for what, f in cases if f]
    return check(name, not faults, "\n".join(faults))


def differences(want, got, where=""):
    """Where ${got} is not ${want}: more members may be there, none may be missing."""
    if isinstance(want, dict):
        if not isinstance(got, dict):
            return [f"{where}: {got}"]
        out = [f"{where}.{k}: missing" for k in want if k not in got]
        for k in set(want) & set(got):
            out += differences(want[k], got[k], f"{where}.{k}")
        return out
    if isinstance(want, list):
        if not isinstance(got, list) or len(got) != len(want):
            return [f"{where}: {got}, not {want}"]
        out = []
        for i, (w, g) in enumerate(zip(want, got)):
            out += differences(w, g, f"{where}[{i}]")
        return out
    same_kind = isinstance(want, bool) == isinstance(got, bool)
    return [] if want == got and same_kind else [f"{where}: {got!r}, not {want!r}"]


def at(report, path):
    """at(r, "bodies.0.volume"); None where there is no such thing."""
    for part in path.split("."):
        try:
            report = report[int(part) if isinstance(report, list) else part]
        except (KeyError, IndexError, TypeError, ValueError):
            return None
    return report


def near(got, want, relative=1e-12):
    """Numbers or lists of numbers, of one shape."""
    if isinstance(want, (list, tuple)):
        return (isinstance(got, list) and len(got) == len(want)
                and all(near(g, w, relative) for g, w in zip(got, want)))
    number = isinstance(got, (int, float)) and not isinstance(got, bool)
    return number and abs(got - want) <= relative * max(abs(want), 1e-300)


def untimed(report):
    """The report without what may differ from call to call."""
    return {k: v for k, v in (report or {}).items() if k != "timing_ms"}


def warnings(report):
    return {w["code"] for w in (report or {}).get("warnings", [])}
