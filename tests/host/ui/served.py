"""The server of the page in a thread of the test, and a board that is only a list of lines."""

import asyncio
import json
import queue
import threading
import time
from http.client import HTTPConnection

from sixflip_host.ui.bench import Bench
from sixflip_host.ui.server import Server

WAIT_S = 120


class Served:
    """Context manager: a Server that runs; bench(told) makes its Bench; more: of the Server."""

    def __init__(self, bench, **more):
        self.server = Server(bench, **more)
        self.loop = asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.ready = threading.Event()

    def run(self):
        asyncio.set_event_loop(self.loop)
        self.loop.run_until_complete(self.server.start())
        self.ready.set()
        self.loop.run_forever()

    def __enter__(self):
        self.thread.start()
        assert self.ready.wait(WAIT_S)
        return self

    def __exit__(self, *error):
        self.server.bench.close()
        asyncio.run_coroutine_threadsafe(self.server.stop(), self.loop).result(WAIT_S)
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join(WAIT_S)
        self.loop.close()

    def request(self, path, method="GET", body=None, **headers):
        """(status, headers, body); header names with _ for -; Host as given or our own."""
        link = HTTPConnection("127.0.0.1", self.server.port, timeout=WAIT_S)
        sent = {name.replace("_", "-"): value for name, value in headers.items()}
        link.putrequest(method, path, skip_host=True)
        for name, value in dict({"Host": "127.0.0.1:%d" % self.server.port}, **sent).items():
            link.putheader(name, value)
        data = body.encode() if body else b""
        link.putheader("Content-Length", str(len(data)))
        link.endheaders(data)
        answer = link.getresponse()
        first = answer.readline() if path == "/api/states" else answer.read()
        link.close()
        return answer.status, dict(answer.getheaders()), first

    def do(self, action, number, what=""):
        status, _, body = self.request(
            "/api/do", "POST", json.dumps({"action": action, "number": number, "what": what}),
            Content_Type="application/json", X_Sixflip_Token=self.server.token)
        return status, json.loads(body)


class ScriptedLink:
    """A board whose lines the test puts in; keeps what it is sent."""

    port = "scripted"

    def __init__(self):
        self.said = queue.SimpleQueue()
        self.sent = []
        self.resets = self.closed = 0

    def files(self, hashed=None):
        return {"main.py": (1, None)}

    def put(self, name, data, progress=None):
        self.sent.append((name, data))

    def board_id(self):
        return "00aa"

    def reset(self):
        self.resets += 1

    def lines(self, timeout):
        while True:
            try:
                yield self.said.get(timeout=timeout)
            except queue.Empty:
                return

    def say(self, event, **fields):
        self.said.put(json.dumps(dict({"event": event}, **fields)))

    def send(self, line):
        command = json.loads(line) if line else {}
        if command:
            self.sent.append(command)
        if command.get("cmd") == "stop":
            self.say("capture", samples=700)
            self.say("ready")

    def asked(self, name):
        """Whether a command was sent to it."""
        return any(isinstance(sent, dict) and sent.get("cmd") == name for sent in self.sent)

    def close(self):
        self.closed += 1


def until(holds, so_far=lambda: ""):
    """Wait for something that another thread does; so_far() says what there is where it fails."""
    end = time.monotonic() + WAIT_S
    while not holds():
        assert time.monotonic() < end, "it never came: %s" % (so_far(),)
        time.sleep(0.01)


def scripted(tmp_path, **more):
    """(link, make) of a Bench at a ScriptedLink that keeps no history."""
    link = ScriptedLink()
    return link, lambda told: Bench(lambda: link, tmp_path, told, keep=False, **more)
