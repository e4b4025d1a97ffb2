"""The contract: served as it stands, valid OpenAPI 3.1 (a validator from npm), and true of what the
service has.  That every answer fits its schemas is checked by the harness in every test file."""
import json
import os
import re
import subprocess

import schema
from harness import Daemon, box, check, finish, stl

VALIDATOR = "@seriousme/openapi-schema-validator@2.11.0"
BUILD = os.path.join(schema.ROOT, "build", "npm")


def npm_validator():
    """The validator's command, installed on first use; None where npm cannot get it."""
    command = os.path.join(BUILD, "node_modules", ".bin", "validate-api")
    if not os.path.exists(command):
        os.makedirs(BUILD, exist_ok=True)
        subprocess.run(["npm", "install", "--silent", "--no-audit", "--no-fund", "--prefix", BUILD,
                        VALIDATOR], capture_output=True, timeout=200)
    return command if os.path.exists(command) else None


def check_valid():
    path = os.path.join(schema.ROOT, "api", "openapi.json")
    command = npm_validator()
    if command is None:
        check("the contract is valid OpenAPI # SKIP npm cannot get the validator", True)
        return
    done = subprocess.run([command, path], capture_output=True, text=True, timeout=60)
    check("the contract is valid OpenAPI", done.returncode == 0 and '"valid": true' in done.stdout,
          done.stdout + done.stderr)
    broken = os.path.join(BUILD, "broken.json")
    with open(path, encoding="utf-8") as f, open(broken, "w", encoding="utf-8") as g:
        g.write(f.read().replace('"responses"', '"answers"'))
    done = subprocess.run([command, broken], capture_output=True, text=True, timeout=60)
    check("and a broken one would not be", '"valid": true' not in done.stdout, done.stdout)


def check_true_of(d):
    with open(os.path.join(schema.ROOT, "api", "openapi.json"), "rb") as f:
        served = d.get("/openapi.json")
        check("it is served as it stands", served.status == 200 and served.body == f.read(), served)
    for path, item in schema.DOCUMENT["paths"].items():
        for method in item:
            a = d.curl(path, "-X", method.upper(), "-H", "Content-Type:")
            check(f"{method.upper()} {path} exists", a.status not in (0, 404, 405), a)
    parameters = schema.DOCUMENT["components"]["parameters"]
    options = {p["name"] for p in parameters.values()}
    capable = d.get("/v1/capabilities").json
    check("its parameters are the options", options == set(capable["options"]),
          options ^ set(capable["options"]))
    for path in ("/v1/mass-properties", "/v1/mesh"):
        named = {p["$ref"].rpartition("/")[2] for p in
                 schema.DOCUMENT["paths"][path]["post"]["parameters"]}
        check(f"all of them are {path}'s", named == set(parameters), named ^ set(parameters))
    taken = set(schema.DOCUMENT["components"]["requestBodies"]["Mesh"]["content"])
    check("its media types are those taken", taken == set(capable["media_types"]),
          taken ^ set(capable["media_types"]))
    formats = schema.DOCUMENT["components"]["schemas"]["Input"]["properties"]["format"]["enum"]
    check("its formats are those read", set(capable["formats"]) <= set(formats), formats)


def check_readme(d):
    """The report in the README is one that the program gives."""
    with open(os.path.join(schema.ROOT, "README.md"), encoding="utf-8") as f:
        shown = json.loads(re.search(r"```json\n(\{.*?\n\})\n```", f.read(), re.S)[1])
    a = d.post(stl(box((0, 0, 0), (1, 2, 3))), query="unit=mm&density=1")

    def members(x, where=""):
        return {where + "." + k for k in x} | {m for k, v in x.items() if isinstance(v, dict)
                                               for m in members(v, where + "." + k)}

    check("the README shows the report as it is", members(shown) == members(a.json),
          members(shown) ^ members(a.json))


def check_notices(d):
    """The check in the harness can fail."""
    a = d.post(stl(box((0, 0, 0), (1, 2, 3))), query="unit=mm")
    check("a report fits", schema.faults("/v1/mass-properties", a) == [], a)
    for what, change in (("a missing member", lambda r: r.pop("checks")),
                         ("an unknown member", lambda r: r.update(extra=1)),
                         ("a wrong type", lambda r: r["mesh"].update(triangles="12")),
                         ("a short vector", lambda r: r["properties"].update(centroid=[1, 2]))):
        a = d.post(stl(box((0, 0, 0), (1, 2, 3))), query="unit=mm")
        change(a.json)
        check(f"{what} is noticed", schema.faults("/v1/mass-properties", a) != [])


def check_codes():
    with open(os.path.join(schema.ROOT, "api", "problem.c"), encoding="utf-8") as f:
        table = set(re.findall(r'"([a-z]+(?:_[a-z]+)*)"', f.read()))
    codes = set(schema.DOCUMENT["components"]["schemas"]["Problem"]["properties"]["code"]["enum"])
    check("its problem codes are those of the table", codes <= table, codes - table)


with Daemon() as daemon:
    check_valid()
    check_true_of(daemon)
    check_readme(daemon)
    check_notices(daemon)
    check_codes()
finish()
