"""HTTP/1.1 by hand, for what curl would not send or would not show."""
import ctypes
import json
import socket


def library():
    """The major version of the libmicrohttpd that the daemon is linked to; 0 where nobody knows."""
    try:
        say = ctypes.CDLL("libmicrohttpd.so.12").MHD_get_version
    except OSError:
        return 0
    say.restype = ctypes.c_char_p
    return int(say().split(b".")[0])


LIBRARY = library()


class Reply:
    """One answer off the wire: status, reason, headers (lower case), body, json, end (offset)."""

    def __init__(self, data, start, bodyless):
        stop = data.index(b"\r\n\r\n", start)
        lines = data[start:stop].decode("latin-1").split("\r\n")
        self.version, status, self.reason = (lines[0].split(None, 2) + ["", ""])[:3]
        self.status, self.headers = int(status), {}
        for line in lines[1:]:
            name, _, value = line.partition(":")
            self.headers[name.strip().lower()] = value.strip()
        self.end = stop + 4
        length = int(self.headers.get("content-length", 0))
        if not (bodyless or self.status < 200 or self.status in (204, 304)):
            self.end += length
        self.body = data[stop + 4:self.end]
        if self.end > len(data):
            raise ValueError("cut off in the body")
        try:
            self.json = json.loads(self.body)
        except ValueError:
            self.json = None

    def __str__(self):
        return f"{self.status} {self.headers} {self.body[:400]!r}"


def replies(data, head=False):
    """All complete answers in ${data}; ${head}: they answer HEAD, so have no body."""
    out, start = [], 0
    while True:
        try:
            out.append(Reply(data, start, head))
        except ValueError:
            return out
        start = out[-1].end


def request(method="GET", path="/livez", headers=(), body=b"", version="HTTP/1.1", length=None):
    """Bytes of a request; Content-Length by itself where there is a body."""
    lines = [f"{method} {path} {version}", "Host: test"] + list(headers)
    if body or length is not None:
        lines.append(f"Content-Length: {len(body) if length is None else length}")
    return "\r\n".join(lines).encode("latin-1") + b"\r\n\r\n" + body


def post(body, query="", headers=(), length=None):
    path = "/v1/mass-properties" + ("?" + query if query else "")
    return request("POST", path, ["Content-Type: model/stl", *headers], body, length=length)


def chunked(pieces):
    """The body of a Transfer-Encoding: chunked."""
    return b"".join(b"%x\r\n%s\r\n" % (len(p), p) for p in pieces if p) + b"0\r\n\r\n"


class Wire:
    """One connection.  send(), then read(): ${closed} says whether the peer has closed."""

    def __init__(self, port, timeout=10):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.data, self.closed, self.used = b"", False, 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, data):
        """False where the peer takes no more."""
        try:
            self.socket.sendall(data)
            return True
        except OSError:
            return False

    def finish(self):
        """No more will come from here."""
        self.socket.shutdown(socket.SHUT_WR)

    def _more(self):
        try:
            chunk = self.socket.recv(65536)
        except socket.timeout:
            return False
        except OSError:
            chunk = b""
        self.data += chunk
        self.closed = not chunk
        return bool(chunk)

    def read(self, count=1, head=False):
        """The next ${count} answers, fewer where the peer closes or is silent for too long."""
        while len(replies(self.data[self.used:], head)) < count and not self.closed:
            if not self._more():
                break
        got = replies(self.data[self.used:], head)[:count]
        self.used += got[-1].end if got else 0
        return got

    def one(self, head=False):
        """The next answer that is final, or None."""
        while got := self.read(1, head):
            if got[0].status >= 200:
                return got[0]
        return None

    def ends(self):
        """Does the peer close (with nothing more to say) before the timeout?"""
        while not self.closed and self._more():
            pass
        return self.closed


def ask(port, data, timeout=10, head=False):
    """One request, one answer (or None), on a connection of its own."""
    with Wire(port, timeout) as w:
        w.send(data)
        return w.one(head)
