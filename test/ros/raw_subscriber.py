"""A subscriber without a client library, which can misbehave: in what it reads, and in what getBusStats answers."""
import http.server
import socket
import socketserver
import struct
import threading
import time
import xmlrpc.client

import rosgraph

TIMEOUT = 60.0  # [s]


def answer(value):
    """The body of an ordinary answer."""
    return xmlrpc.client.dumps((value,), methodresponse=True, allow_none=True).encode()


def header_fields(fields):
    encoded = b"".join(struct.pack("<I", len(key) + len(value) + 1) + key.encode() + b"=" + value.encode()
                       for key, value in fields.items())
    return struct.pack("<I", len(encoded)) + encoded


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        method = xmlrpc.client.loads(body)[1]
        self.server.calls[method] = self.server.calls.get(method, 0) + 1
        if method == "getBusStats":
            return self.server.bus_stats(self)
        return self.reply(answer([1, "", 0]))

    def reply(self, body, code=200, length=None):
        self.send_response(code)
        self.send_header("Content-Type", "text/xml")
        self.send_header("Content-Length", str(len(body) if length is None else length))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_):
        pass


class Server(socketserver.ThreadingMixIn, http.server.HTTPServer):
    daemon_threads = True

    def handle_error(self, request, client_address):
        pass  # the node has closed a connection: it may


class RawSubscriber:
    """bus_stats(handler) answers the call; None: truly. delay [s] after each message; None: nothing is ever read."""

    def __init__(self, name, topic, bus_stats=None, delay=0.0, receive_buffer=None):
        self.name, self.topic, self.delay = name, topic, delay
        self.sequence = []  # header.seq of each message
        self.server = Server(("localhost", 0), Handler)
        self.server.calls = {}
        self.server.bus_stats = bus_stats or self.true_bus_stats
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.master = rosgraph.Master(name)
        self.uri = "http://localhost:%d/" % self.server.server_address[1]
        publishers = self.master_proxy().registerSubscriber(name, topic, "*", self.uri)[2]
        _, host, port = xmlrpc.client.ServerProxy(publishers[0]).requestTopic(name, topic, [["TCPROS"]])[2]
        self.socket = socket.socket()
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.connect((host, port))
        self.socket.sendall(header_fields({"callerid": name, "topic": topic, "md5sum": "*", "type": "*",
                                           "tcp_nodelay": "1"}))
        self.stream = self.socket.makefile("rb")
        self.stream.read(struct.unpack("<I", self.stream.read(4))[0])
        self.thread = threading.Thread(target=self.read, daemon=True)
        if delay is not None:
            self.thread.start()

    def master_proxy(self):
        return xmlrpc.client.ServerProxy(rosgraph.get_master_uri())

    def read(self):
        try:
            while True:
                size = struct.unpack("<I", self.stream.read(4))[0]
                self.sequence.append(struct.unpack("<I", self.stream.read(size)[:4])[0])
                time.sleep(self.delay) if self.delay else None
        except (struct.error, OSError, ValueError):
            pass  # the connection is closed

    def true_bus_stats(self, handler):
        handler.reply(answer([1, "", [[], [[self.topic, [[1, 0, len(self.sequence), 0, 1]]]], []]]))

    def asked(self):
        """How often the node has asked for bus statistics."""
        return self.server.calls.get("getBusStats", 0)

    def close(self):
        self.socket.close()
        self.master_proxy().unregisterSubscriber(self.name, self.topic, self.uri)
        self.server.shutdown()
        self.server.server_close()
