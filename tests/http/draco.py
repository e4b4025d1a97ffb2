"""Draco files for the tests: by the real encoder, by hand, and such as are made to do harm."""
import os
import struct
import subprocess
import tempfile

# ------------------------------------------------------------------------------ by the encoder


def obj(mesh, extras=False):
    """OBJ text with shared vertices; ${extras}: each face with normals and texture coordinates."""
    number, lines, faces = {}, [], []
    for t in mesh:
        for p in t:
            if p not in number:
                number[p] = len(number) + 1
                lines.append("v " + " ".join(repr(float(x)) for x in p))
    if extras:
        lines += [f"vt {i / 7} {i / 9}" for i in range(7)]
        lines += ["vn 1 0 0", "vn 0 1 0", "vn 0.6 0 0.8"]
    for i, t in enumerate(mesh):
        if extras:
            corners = (f"{number[p]}/{(i + k) % 7 + 1}/{i % 3 + 1}" for k, p in enumerate(t))
        else:
            corners = (str(number[p]) for p in t)
        faces.append("f " + " ".join(corners))
    return ("\n".join(lines + faces) + "\n").encode()


def encode(data, *flags):
    """What draco_encoder makes of an OBJ file."""
    return _convert("draco_encoder", data, "in.obj", "out.drc", *flags)


def decode(data):
    """The triangles that draco_decoder makes of it, as exact doubles."""
    ply = _convert("draco_decoder", data, "in.drc", "out.ply")
    head, _, rest = ply.partition(b"end_header\n")
    sizes = {"float": 4, "float32": 4, "uchar": 1, "uint8": 1}
    vertices = faces = stride = 0
    in_vertex = False
    for line in head.decode().splitlines():
        word = line.split()
        if word[0] == "element":
            in_vertex = word[1] == "vertex"
            if in_vertex:
                vertices = int(word[2])
            else:
                faces = int(word[2])
        elif word[0] == "property" and in_vertex:
            stride += sizes[word[1]]
    point = [struct.unpack_from("<3f", rest, stride * i) for i in range(vertices)]
    at, mesh = stride * vertices, []
    each = (len(rest) - at) // faces if faces else 0
    for i in range(faces):
        mesh.append(tuple(point[k] for k in struct.unpack_from("<3i", rest, at + each * i + 1)))
    return mesh


def _convert(program, data, source, target, *flags):
    with tempfile.TemporaryDirectory() as tmp:
        source, target = os.path.join(tmp, source), os.path.join(tmp, target)
        with open(source, "wb") as f:
            f.write(data)
        done = subprocess.run([program, "-i", source, "-o", target, *flags], capture_output=True,
                              timeout=60)
        if done.returncode != 0:
            raise RuntimeError(f"{program}: {done.stdout} {done.stderr}")
        with open(target, "rb") as f:
            return f.read()


# -------------------------------------------------------------------------------------- by hand

HEAD = b"DRACO\2\2\1"  # a mesh of bitstream 2.2; the method and two bytes of flags follow
POSITION, NORMAL = 0, 1
FLOAT32, FLOAT64 = 9, 10


def varint(n):
    out = b""
    while n > 127:
        out += bytes([n & 127 | 128])
        n >>= 7
    return out + bytes([n])


def attribute(kind=POSITION, data=FLOAT32, components=3):
    """The description of one attribute whose values follow as they are."""
    return bytes([1, kind, data, components, 0, 0, 0])


def sequential(points, faces, kind=POSITION):
    """Uncompressed throughout; fewer than 256 points."""
    return (HEAD + b"\0\0\0" + varint(len(faces)) + varint(len(points)) + b"\1"
            + b"".join(bytes(f) for f in faces) + b"\1" + attribute(kind)
            + b"".join(struct.pack("<3f", *p) for p in points))


# ------------------------------------------------------------------------------------- to do harm
# The edgebreaker method says how one triangle after the other is glued on, in five symbols:
# E begins a triangle, L and R add one at an edge, C closes a gap, S joins two pieces.

BITS = {"C": (0, 1), "S": (1, 3), "L": (3, 3), "R": (5, 3), "E": (7, 3)}


def _counts(traversal, vertices, faces, splits):
    return (HEAD + b"\1\0\0" + bytes([traversal]) + varint(vertices) + varint(faces) + b"\0"
            + varint(faces) + varint(splits) + b"\0")


def standard(symbols, faces=None):
    """The traversal with a bit or three for a symbol; ${faces} may say what it will."""
    value = length = 0
    data = bytearray()
    for s in symbols:
        value |= BITS[s][0] << length
        length += BITS[s][1]
        while length >= 8:
            data.append(value & 255)
            value, length = value >> 8, length - 8
    if length:
        data.append(value)
    splits = symbols.count("S")
    vertices = 3 * symbols.count("E") + symbols.count("R") + symbols.count("L")
    n = len(symbols) if faces is None else faces
    return (_counts(0, vertices - splits, n, splits) + varint(len(data)) + bytes(data) + b"\xff\1\0"
            + b"\1\xff\0\0" + attribute())


def spinner(n):
    """8n + 3n + 3n bits: a fan of n triangles, of which each of n joints renames every corner."""
    return standard("E" * (n + 1) + "R" * n + "SCC" * n)


def _all(n, symbol):
    """n times the same symbol, entropy coded: no bits at all, whatever n is."""
    zeros = bytes([symbol - 1 << 2 | 3]) if symbol else b""
    return varint(n) + b"\1\3" + varint(symbol + 1) + zeros + b"\1\x40" + b"\1\0" if n else b"\0"


def islands(n):
    """n separate triangles in some 60 bytes: libdraco makes room for them all, then gives up."""
    return _counts(2, 3 * n, n, 0) + b"\xff\1\0" + _all(n - 1, 4) + bytes(5) + b"\1\xff\0\0" \
        + attribute()


def fan(n, data=FLOAT64, components=255):
    """n triangles about a point in some 95 bytes, and room for n positions of 2040 bytes each."""
    contexts = b"".join(_all(k, 3) for k in (1, 1, 1, 1, 1, n - 6))
    return _counts(2, n + 2, n, 0) + b"\xff\1\x3f" + contexts + b"\1\xff\0\0" \
        + attribute(POSITION, data, components)
