"""Who may talk to the server: this machine's browser, with the page's own address and the token.

Against DNS rebinding the Host header must be the address the server listens on; against other
sites the Origin must be our own; and what is worth anything needs the token that only the
printed address holds. It is sent in a header, which no other site can make a browser do.
"""

import hmac

from aiohttp import web

from ..errors import internal_error

TOKEN_HEADER = "X-Sixflip-Token"
PAGE_POLICY = ("default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
               "img-src 'self' data:; frame-src 'self'; base-uri 'none'; form-action 'none'; "
               "frame-ancestors 'none'")
# A report is one file with its styles and pictures inside; scripts it has none.
REPORT_POLICY = ("default-src 'none'; style-src 'unsafe-inline'; img-src data:; sandbox; "
                 "base-uri 'none'; form-action 'none'; frame-ancestors 'self'")
HEADERS = {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer",
           "Cache-Control": "no-store", "Cross-Origin-Resource-Policy": "same-origin",
           "Cross-Origin-Opener-Policy": "same-origin"}


def hosts(port):
    """The Host headers that name this server."""
    return {"127.0.0.1:%d" % port, "localhost:%d" % port}


def refusal(request, port, token):
    """Why a request is refused, "" when it is not."""
    if request.headers.getall("Host", []) not in [[name] for name in hosts(port)]:
        return "this server answers to %s only" % " and ".join(sorted(hosts(port)))
    for origin in request.headers.getall("Origin", []):
        if origin not in {"http://" + name for name in hosts(port)}:
            return "requests of other sites are refused"
    if request.headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin"):
        return "requests of other sites are refused"
    if request.path.startswith("/api/"):
        given = request.headers.get(TOKEN_HEADER, "")
        if not hmac.compare_digest(given.encode("utf-8", "replace"), token.encode()):
            return "open the address that sixflip ui printed: it holds the key to this page"
        if request.method == "POST" and request.content_type != "application/json":
            return "expected JSON"
    return ""


def middleware(port, token):
    """port(): the port listened on, known once it listens."""
    @web.middleware
    async def guard(request, handler):
        reason = refusal(request, port(), token)
        if reason:
            response = web.json_response({"error": reason}, status=403)
        else:
            try:
                response = await handler(request)
            except web.HTTPException as error:
                response = web.json_response({"error": error.reason}, status=error.status)
            except Exception as error:      # noqa: BLE001  for the page, not the terminal
                response = web.json_response({"error": internal_error(error)}, status=500)
        if not response.prepared:
            response.headers.update(HEADERS)
            response.headers.setdefault("Content-Security-Policy", PAGE_POLICY)
        return response
    return guard
