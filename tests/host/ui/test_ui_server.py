"""Who may talk to the server, and what strangers get."""

import json
import re
import signal
import socket
import subprocess
import sys
from http.client import HTTPConnection

import pytest
from served import Served, scripted, until

from sixflip_host import cli
from sixflip_host.capture import capture_file
from sixflip_host.ui import guard
from tests.worlds.board_session import unlabelled


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    link, make = scripted(tmp_path_factory.mktemp("pulled"))
    with Served(make) as served:
        served.link = link
        yield served


PATHS = ["/", "/app.js", "/api/states", "/api/do"]


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("host", ["evil.example", "evil.example:{port}", "127.0.0.1",
                                  "127.0.0.1:1", "127.0.0.1:{port}.evil.example", ""])
def test_another_host_name_is_refused(served, path, host):
    """A name that was made to point here: DNS rebinding."""
    host = host.format(port=served.server.port)
    status, _, body = served.request(path, Host=host, X_Sixflip_Token=served.server.token)
    assert status == 403 and b"answers to" in body


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("headers", [
    {"Origin": "http://evil.example"}, {"Origin": "null"}, {"Origin": "http://127.0.0.1:1"},
    {"Sec_Fetch_Site": "cross-site"}, {"Sec_Fetch_Site": "same-site"}])
def test_another_sites_page_is_refused(served, path, headers):
    status, answer, body = served.request(path, X_Sixflip_Token=served.server.token, **headers)
    assert status == 403 and b"other sites" in body
    assert not [name for name in answer if name.startswith("Access-Control")]


@pytest.mark.parametrize("token", ["", "x", "\xe4"])
def test_without_the_token_there_is_the_page_alone(served, token):
    assert served.request("/")[0] == 200
    status, _, body = served.request("/api/states", X_Sixflip_Token=token)
    assert status == 403 and b"sixflip ui printed" in body


def test_a_preflight_is_not_answered(served):
    status, headers, _ = served.request(
        "/api/do", "OPTIONS", Origin="http://evil.example",
        Access_Control_Request_Headers="x-sixflip-token", Access_Control_Request_Method="POST")
    assert status == 403 and "Access-Control-Allow-Origin" not in headers


def test_with_the_token_and_our_own_origin(served):
    origin = "http://127.0.0.1:%d" % served.server.port
    status, _, line = served.request("/api/states", X_Sixflip_Token=served.server.token,
                                     Origin=origin, Sec_Fetch_Site="same-origin")
    view = json.loads(line)
    assert status == 200 and view["number"] == 0 and view["trail"] == []
    assert served.request("/", Host="localhost:%d" % served.server.port)[0] == 200


@pytest.mark.parametrize("body, kind", [
    ("{", "application/json"), ("[]", "application/json"), ('{"action": "start"}', "text/plain"),
    ('{"action": "format", "number": 0}', "application/json"),
    ('{"action": "redo", "number": 0, "what": "Q"}', "application/json"),
    ('{"action": "start", "number": "0"}', "application/json"),
    ('{"action": "start", "number": true}', "application/json"),
    ('{"action": "undo", "number": 0, "what": "%s"}' % ("x" * 9), "application/json"),
    ("x" * 5000, "application/json"), ("[" * 3000, "application/json"),
    ('{"action": "start", "number": 0, "what": %s1}' % ('{"a":' * 600), "application/json"),
    ('{"action": ["start"], "number": 0}', "application/json")])
def test_actions_that_make_no_sense(served, body, kind):
    status, _, _ = served.request("/api/do", "POST", body, Content_Type=kind,
                                  X_Sixflip_Token=served.server.token)
    assert status in (400, 403, 413) and served.link.resets == 0


@pytest.mark.parametrize("sent", [
    b"\x16\x03\x01\x02\x00\x01\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9.x\r\n\r\n",
    b"GET / HTTP/1.1\r\nHost\r\n\r\n", b"GET / HTTP/1.1\r\nA: " + b"x" * 70000 + b"\r\n\r\n",
    b"POST /api/do HTTP/1.1\r\nHost: x\r\nContent-Length: -5\r\n\r\n",
    b"POST /api/do HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n"])
def test_a_request_that_is_none_leaves_the_terminal_alone(served, sent, caplog, capfd):
    with socket.create_connection(("127.0.0.1", served.server.port), timeout=30) as link:
        link.sendall(sent)
        assert link.recv(100).split()[1] in (b"400", b"403")
    assert served.request("/")[0] == 200
    assert caplog.records == [] and capfd.readouterr().err == ""


def test_a_failure_of_ours_is_a_sentence_and_no_traceback(served, monkeypatch, caplog):
    monkeypatch.setattr(served.server.bench, "ask", lambda *words: 1 / 0)
    status, answer = served.do("start", 0)
    assert status == 500 and "internal error" in answer["error"]
    assert caplog.records == []


@pytest.mark.parametrize("path", [
    "/..%2f..%2fcli.py", "/static/app.js", "/../ui.py", "/app.js/", "/report/x.html",
    "/api/report"])
def test_nothing_else_is_served(served, path):
    assert served.request(path, X_Sixflip_Token=served.server.token)[0] == 404


def test_every_answer_has_its_guards(served):
    _, headers, _ = served.request("/")
    assert headers["Content-Security-Policy"] == guard.PAGE_POLICY
    assert "unsafe" not in guard.PAGE_POLICY
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Cache-Control"] == "no-store"
    assert [address[0] for address in served.server.runner.addresses] == ["127.0.0.1"]


def test_the_page_makes_no_markup_of_texts():
    from sixflip_host.ui.server import STATIC
    scripts = "".join(path.read_text() for path in STATIC.glob("*.js"))
    for way in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval("):
        assert way not in scripts
    assert "<script>" not in (STATIC / "index.html").read_text()


def test_an_action_reaches_the_board(served):
    assert served.do("start", 0) == (200, {"ok": True})
    until(lambda: served.link.resets == 1)
    assert ("calibrate.flag", b"") in served.link.sent


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_command_ends_its_session_in_order(tmp_path, number):
    capture_file.write(tmp_path / "capture.csv", unlabelled())
    with subprocess.Popen(
            [sys.executable, "-m", "sixflip_host", "ui", "--replay", "capture.csv"],
            cwd=tmp_path, stdout=subprocess.PIPE, text=True) as child:
        port, token = re.search(r":(\d+)/#(\S+)", child.stdout.readline()).groups()
        link = HTTPConnection("127.0.0.1", int(port), timeout=60)
        link.request("POST", "/api/do", '{"action": "start", "number": 0}',
                     {"Content-Type": "application/json", "X-Sixflip-Token": token})
        assert link.getresponse().read() == b'{"ok": true}'
        link.request("GET", "/api/states", headers={"X-Sixflip-Token": token})
        states = link.getresponse()
        while json.loads(states.readline())["stage"] != "calibrating":
            continue
        states.close()
        link.close()
        child.send_signal(number)
        assert child.stdout.read() == "stopped; of a replay nothing is kept\n"
        assert child.wait() == 0


@pytest.mark.parametrize("argv, line, code", [
    (["--speed", "2"], "with --replay", 2), (["--listen", "70000"], "expected a port", 2),
    (["--replay", "no_such_file"], "No such file", 4), (["--session", "2"], "only with --plan", 2),
    (["--replay", "x", "--plan", "paper"], "as it was taken", 2),
    (["--replay", "x", "--port", "y"], "not allowed with", 2)])
def test_command_lines_that_cannot_be(argv, line, code, capsys):
    assert cli.main(["ui", *argv]) == code
    assert line in capsys.readouterr().err


def test_a_port_that_is_taken(served, capsys):
    assert cli.main(["ui", "--listen", str(served.server.port)]) == 2
    assert "--listen %d" % served.server.port in capsys.readouterr().err
