"""The server behind the page: files, a stream of states, actions. Bound to this machine."""

import asyncio
import json
import logging
import secrets
from pathlib import Path

from aiohttp import web

from sixflip.poses.faces import FACES

from . import guard
from .bench import ACTIONS

STATIC = Path(__file__).resolve().parent / "static"
FILES = {"/style.css": "text/css", **{
    "/%s.js" % name: "text/javascript" for name in ("page", "app", "tray", "box", "plots")}}
# aiohttp's own words on requests that are none: who sent them has had his answer.
QUIET = logging.Logger("requests")  # noqa: LOG001  beside the tree of loggers: it is heard nowhere
QUIET.disabled = True
FASTEST_S = 0.1         # between two states of a stream
SLOWEST_S = 2.0


class Server:
    """make(told) -> Bench, which calls told() from its thread when something changed; page: the
    file that is shown for it."""

    def __init__(self, make, port=0, page="index.html"):
        self.page = page
        self.token = secrets.token_urlsafe(24)
        self.report_name = secrets.token_urlsafe(24)
        self.wanted_port = port
        self.port = None
        self.loop = None
        self.changed = None
        self.bench = make(self.told)
        self.runner = None

    def told(self):
        loop = self.loop
        if loop and not loop.is_closed():
            loop.call_soon_threadsafe(self.wake)

    def wake(self):
        """Everybody who waits for the next state."""
        changed, self.changed = self.changed, asyncio.Event()
        changed.set()

    @property
    def url(self):
        """The address to open; what stands behind the # never leaves the browser."""
        return "http://127.0.0.1:%d/#%s" % (self.port, self.token)

    def app(self):
        app = web.Application(client_max_size=4096,
                              middlewares=[guard.middleware(lambda: self.port, self.token)])
        for path in ("/", *FILES):
            app.router.add_get(path, self.file)
        app.router.add_get("/api/states", self.states)
        app.router.add_get("/api/report", self.report_path)
        app.router.add_post("/api/do", self.do)
        app.router.add_get("/report/" + self.report_name + ".html", self.report)
        return app

    async def start(self):
        self.loop = asyncio.get_running_loop()
        self.changed = asyncio.Event()
        self.runner = web.AppRunner(self.app(), access_log=None, shutdown_timeout=1.0,
                                    logger=QUIET)
        await self.runner.setup()
        site = web.TCPSite(self.runner, "127.0.0.1", self.wanted_port)
        await site.start()
        self.port = self.runner.addresses[0][1]
        self.bench.thread.start()

    async def stop(self):
        await self.runner.cleanup()

    async def file(self, request):
        name = request.path[1:] or self.page
        return web.Response(body=(STATIC / name).read_bytes(), charset="utf-8",
                            content_type=FILES.get(request.path, "text/html"))

    async def states(self, request):
        """One JSON object a line for as long as the browser listens; the first has the trail."""
        response = web.StreamResponse(headers=dict(guard.HEADERS, **{
            "Content-Type": "application/x-ndjson"}))
        await response.prepare(request)
        first = True
        while not self.bench.over.is_set():
            changed = self.changed
            view = self.bench.view()
            if first:
                view["trail"] = self.bench.trail()
            first = False
            try:
                await response.write((json.dumps(view, allow_nan=False) + "\n").encode())
            except (ConnectionError, RuntimeError):     # the tab was closed
                break
            await asyncio.sleep(FASTEST_S)
            try:
                await asyncio.wait_for(changed.wait(), SLOWEST_S)
            except asyncio.TimeoutError:
                continue
        return response

    async def do(self, request):
        """{"action": …, "number": session seen, "what": face or pose}"""
        try:
            asked = await request.json()
            action, number = asked["action"], asked["number"]
            what = asked.get("what", "")
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise web.HTTPBadRequest(reason="expected action and number") from None
        if action not in ACTIONS or type(number) is not int or not isinstance(what, str) \
                or len(what) > 8 or action == "redo" and what not in FACES:
            raise web.HTTPBadRequest(reason="expected one of " + " ".join(ACTIONS))
        self.bench.ask(action, number, what)
        return web.json_response({"ok": True})

    async def report_path(self, request):
        """Where the report is: a name nobody can guess, for a frame can send no token."""
        if self.bench.report is None:
            raise web.HTTPNotFound(reason="there is no report yet")
        return web.json_response({"path": "/report/" + self.report_name + ".html"})

    async def report(self, request):
        if self.bench.report is None:
            raise web.HTTPNotFound(reason="there is no report yet")
        return web.Response(body=self.bench.report, content_type="text/html", charset="utf-8",
                            headers={"Content-Security-Policy": guard.REPORT_POLICY})
