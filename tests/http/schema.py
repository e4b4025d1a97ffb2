"""Holds answers against api/openapi.json, strictly: a member that the contract does not name is a
fault, so that no field can be added without being written down."""
import copy
import json
import os

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
LARGEST = 300_000  # bytes; validating longer answers would take longer than making them

try:
    from jsonschema import Draft202012Validator
except ImportError:  # the tests install it; without it they say so once, in finish()
    Draft202012Validator = None

with open(os.path.join(ROOT, "api", "openapi.json"), encoding="utf-8") as f:
    DOCUMENT = json.load(f)


def _closed(node):
    """The same schema with additionalProperties false wherever properties are listed."""
    if isinstance(node, list):
        return [_closed(n) for n in node]
    if not isinstance(node, dict):
        return node
    node = {k: _closed(v) for k, v in node.items()}
    if "properties" in node and node.get("type") == "object":
        node.setdefault("additionalProperties", False)
    return node


_COMPONENTS = _closed(copy.deepcopy(DOCUMENT["components"]))
_validators = {}


def _validator(schema):
    key = json.dumps(schema, sort_keys=True)
    if key not in _validators:
        _validators[key] = Draft202012Validator({**schema, "components": _COMPONENTS})
    return _validators[key]


def _declared(path, status):
    """The responses that the contract has for ${status} of ${path}; None: it does not know the path."""
    item = DOCUMENT["paths"].get(path.split("?")[0])
    if item is None:
        return None
    found = [op["responses"][str(status)] for op in item.values() if str(status) in op["responses"]]
    named = DOCUMENT["components"]["responses"]
    return [named[r["$ref"].rpartition("/")[2]] if "$ref" in r else r for r in found]


def faults(path, answer):
    """What the contract says otherwise of an answer with a JSON body, as a list of sentences."""
    kind = answer.headers.get("content-type", "")
    if Draft202012Validator is None or answer.json is None or len(answer.body) > LARGEST:
        return []
    if answer.status == 404:
        responses = [DOCUMENT["components"]["responses"]["BadRequest"]]
    else:
        responses = _declared(path, answer.status)
    if responses is None:
        return []
    schemas = [r["content"][kind]["schema"] for r in responses if kind in r.get("content", {})]
    if not schemas:
        return [f"{path}: {answer.status} {kind} is not in the contract"]
    errors = [f"{path}: {answer.status} {'/'.join(map(str, e.absolute_path))}: {e.message[:200]}"
              for e in _validator(_closed(schemas[0])).iter_errors(answer.json)]
    return errors[:5]
