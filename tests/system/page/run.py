#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`ifog monitor --web`: the real daemon plays a capture with known figures, which are compared with the page's data; hostile
clients; Chromium shows the page at two widths, light and dark.

usage: run.py BINARY_DIR [FOLDER for the pictures]
"""
import http.client
import http.server
import json
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import private_network  # pylint: disable=wrong-import-position

PORT, RATE_HZ, SWING = 8642, 100, 1e-7
MEANS = {"x": 1e-5, "y": 0.01, "z": -0.02}  # rad/s
FOREIGN = "<img src=x onerror=alert(1)>"
CONFIG = """[daemon]
lock_memory = false
plugin_folder = "{binaries}/plugins"
state_folder = "{work}/state"
[[sensor]]
name = "nose"
model = "{work}/coil.toml"
driver = "capture"
nominal_rate_hz = 100
options = {{ columns = "rate_x_radps,rate_y_radps,rate_z_radps,temperature_degC" }}
transport = {{ type = "file", path = "{work}/three.csv", bytes_per_second = 5800, pace = "recorded" }}
filter = {{ process_noise = 1e-16, measurement_noise = 1e-14 }}
"""

MODEL = """version = 1
sensor = "nose"
[source]
date = "2026-11-26T01:30:59Z"
"""
NO_MODEL = {"identity": "", "sha256": ""}
PROPOSAL = {"schema": "ifog.proposal/1", "sensor": "nose", "made": "2026-11-27T02:00:00Z", "why": "linear in temperature_degC", "against": NO_MODEL,
            "model": NO_MODEL, "model_file": "a.toml", "report_file": "a.html", "gain": []}


def require(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")
    print(f"ok: {what}")


def capture(path):
    """Each axis is its mean ± SWING at random: standard deviation SWING, and Allan deviation of one sample likewise."""
    coin = random.Random(1)
    rows = [",".join([f"{i / RATE_HZ:.3f}", *(f"{mean + coin.choice((-SWING, SWING)):.9e}" for mean in MEANS.values()), "25"]) for i in range(120 * RATE_HZ)]
    pathlib.Path(path).write_text("time_s,rate_x_radps,rate_y_radps,rate_z_radps,temperature_degC\n" + "\n".join(rows) + "\n", encoding="utf-8")


def ask(path, method="GET", **headers):
    connection = http.client.HTTPConnection("127.0.0.1", PORT, timeout=10)
    connection.request(method, path, headers=headers)
    answer = connection.getresponse()
    return answer.status, dict(answer.getheaders()), answer.read().decode()


def wait_for(judge, what, seconds=20):
    end, seen = time.monotonic() + seconds, None
    while time.monotonic() < end:
        try:
            if judge(seen := json.loads(ask("/data")[2])):
                print(f"ok: {what}")
                return seen
        except (ConnectionError, KeyError, IndexError):  # not listening yet, or without a sensor
            pass
        time.sleep(0.2)
    return sys.exit(f"FAILED: {what}; last {json.dumps(seen)[:2000]}")


def figures():
    """Compared with the capture's own numbers."""
    near = lambda value, wanted, within: value is not None and abs(value - wanted) < within
    seen = wait_for(lambda d: len(d["sensor"]["axes"][2]["allan"]) > 3 and len(d["sensor"]["axes"][0]["seconds"]) > 3, "three axes")["sensor"]
    text = "\n".join(line for _, line in seen["lines"])
    for part in ("running", "nothing lost", "driver capture, file /", "three.csv", "temperature_degC 25", "model coil.toml of 2026-11-26 01:30",
                 "proposal of 2026-11-27T02:00:00Z: linear in temperature_degC; adopt with: ifog adopt nose --config"):
        require(part in text, f"the page says {part!r}")
    for axis, (name, mean) in zip(seen["axes"], MEANS.items()):
        require(axis["name"] == name and near(axis["rate_radps"], mean, SWING) and near(axis["raw_noise_radps"], SWING, 0.03 * SWING)
                and axis["noise_radps"] < 0.5 * SWING, f"{name}: rate, raw noise, less noise denoised")
        require(all(near(low, mean - SWING, 1e-3 * SWING) and near(high, mean + SWING, 1e-3 * SWING) for low, high, _ in axis["seconds"][1:]),
                f"{name}: each second lies between the capture's two values")
        require(near(axis["allan"][0], SWING, 0.15 * SWING) and near(axis["allan"][3], SWING / 8 ** 0.5, 0.3 * SWING),
                f"{name}: Allan deviation of one sample and of eight")
    began = time.monotonic()
    time.sleep(3)
    turned = json.loads(ask("/data")[2])["sensor"]["axes"][1]["angle_rad"] - seen["axes"][1]["angle_rad"]
    require(abs(turned / (MEANS["y"] * (time.monotonic() - began)) - 1) < 0.5, "the angle goes on by rate times time")


def strangers(monitor):
    """Read only, for a limited number of clients, and never blocking."""
    require("default-src 'none'" in ask("/")[1]["Content-Security-Policy"], "the page may load nothing from elsewhere")
    parts = ask("/page.js")[2] + ask("/page.css")[2] + ask("/")[2]
    require("innerHTML" not in parts and not re.search(r"https?:|@import|url\(", parts), "no innerHTML, nothing of the network")
    for method, path, host, wanted in (("POST", "/", "localhost", 405), ("GET", "/../etc/passwd", "localhost", 404), ("GET", "/data", "evil.example", 403),
                                       ("GET", "/data", "127.evil.example:80", 403), ("GET", "/data", f"[::1]:{PORT}", 200)):
        require(ask(path, method, Host=host)[0] == wanted, f"{method} {path} for {host}: {wanted}")
    many = ask("/page.js", Range="bytes=" + ",".join(["0-"] * 2000))
    require(many[0] == 200 and len(many[2]) < 20000, "two thousand ranges are one answer")
    resident = []
    for count in (200, 1000):
        for _ in range(count):
            ask("/data?sensor=" + "x" * 4000)
        resident.append(int(re.search(r"VmRSS:\s*(\d+)", pathlib.Path(f"/proc/{monitor.pid}/status").read_text(encoding="utf-8"))[1]))
    require(resident[1] - resident[0] < 4000, f"a thousand questions more, {resident[1] - resident[0]} kB more")
    idle = [socket.create_connection(("127.0.0.1", PORT)) for _ in range(40)]
    for each in idle[:20]:
        each.send(b"GET / HTTP/1.1\r\nX: ")
    require(len(os.listdir(f"/proc/{monitor.pid}/fd")) < 40 and ask("/")[0] == 200, "40 that say nothing: few descriptors, and the page comes")
    return idle


FRAMES = """<!DOCTYPE html><meta charset="utf-8"><body style="margin:0;background:#888"><script>
const out = [], frames = [960, 390].map(width => { const f = document.createElement('iframe'); f.src = '/';
  f.style = `width:${width}px;height:1500px;border:0;margin-right:8px`; document.body.append(f); return f; });
setTimeout(() => { for (const f of frames) { const d = f.contentDocument, box = d.documentElement, all = [...d.querySelectorAll('canvas')];
  out.push({width: f.clientWidth, over: box.scrollWidth - box.clientWidth, canvases: all.length, images: d.images.length, text: d.body.innerText,
    drawn: all.filter(c => c.width && new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer).some(v => v)).length}); }
  if (location.hash) document.body.textContent = 'RESULT' + JSON.stringify(out) + 'END'; }, 4000);
</script>"""


class Stand(http.server.BaseHTTPRequestHandler):
    """The monitor's page in frames, with its data or other data."""
    data = None

    def do_GET(self):  # pylint: disable=invalid-name
        _, headers, body = ask(self.path)
        self.send_response(200)
        self.send_header("Content-Type", "text/html" if self.path == "/frames" else headers["Content-Type"])
        self.end_headers()
        self.wfile.write((FRAMES if self.path == "/frames" else json.dumps(Stand.data) if Stand.data and "/data" in self.path else body).encode())

    def log_message(self, *_):
        pass


def in_chromium(work, pictures):
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if not browser:
        print("SKIPPED in part: no chromium here; tools/install-packages test makes this run")
        return
    stand = http.server.ThreadingHTTPServer(("127.0.0.1", PORT + 1), Stand)
    threading.Thread(target=stand.serve_forever, daemon=True).start()

    def browse(address, *arguments):
        result = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-sync",
                                 "--disable-component-update", "--disable-dev-shm-usage", f"--user-data-dir={work}/profile", "--enable-logging=stderr",
                                 "--window-size=1400,1500", "--virtual-time-budget=8000", *arguments, f"http://127.0.0.1:{PORT + 1}/frames{address}"],
                                capture_output=True, text=True, timeout=90, check=False)
        told = [line for line in result.stderr.splitlines() if "CONSOLE" in line and "source: chrome:" not in line]
        require(not told, f"no message on the console {told or ''}")
        return result.stdout

    def look(judge, what):
        page = browse("#say", "--dump-dom").replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
        for seen in json.loads(re.search("RESULT(.*)END", page, re.S)[1]):
            require(judge(seen), f"{seen['width']} px: {what}")

    look(lambda s: s["over"] <= 0 and s["canvases"] == s["drawn"] == 4 and "running" in s["text"] and "x 2.0" in s["text"], "nothing wider, four pictures, figures")
    shots = [pathlib.Path(pictures, scheme + ".png") for scheme in ("dark", "light")]
    for preferred, shot in enumerate(shots):
        browse("", f"--screenshot={shot}", f"--blink-settings=preferredColorScheme={preferred}")
    require(shots[0].read_bytes() != shots[1].read_bytes(), "dark looks other than light")
    Stand.data = json.loads(ask("/data")[2])
    Stand.data["sensors"] = [[FOREIGN, "good", FOREIGN]]
    Stand.data["sensor"]["lines"].append(["bad", FOREIGN])
    Stand.data["sensor"]["axes"][0]["name"] = FOREIGN
    look(lambda s: s["images"] == 0 and s["text"].count(FOREIGN) == 3, "foreign names are text")
    Stand.data["age_s"] = 60
    look(lambda s: "delayed by 60 s" in s["text"] and "x 2.0" not in s["text"] and "running" not in s["text"], "old figures are not shown")
    stand.shutdown()


def main():
    private_network.enter()
    binaries = os.path.realpath(sys.argv[1])
    with tempfile.TemporaryDirectory() as work:
        capture(f"{work}/three.csv")
        os.mkdir(f"{work}/state")
        pathlib.Path(work, "state/nose.proposal.json").write_text(json.dumps(PROPOSAL), encoding="utf-8")
        pathlib.Path(work, "coil.toml").write_text(MODEL, encoding="utf-8")
        pathlib.Path(work, "ifogd.toml").write_text(CONFIG.format(binaries=binaries, work=work), encoding="utf-8")
        command = [f"{binaries}/tools/ifog/ifog", "monitor", "--web", str(PORT), "--config", f"{work}/ifogd.toml"]
        with open(f"{work}/log", "w", encoding="utf-8") as log, subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as monitor, \
                subprocess.Popen([f"{binaries}/daemon/ifogd", "--config", f"{work}/ifogd.toml"], stdout=log, stderr=log) as daemon:
            try:
                require(f"http://localhost:{PORT}/" in monitor.stdout.readline(), "it says where")
                figures()
                again = subprocess.run(command, capture_output=True, text=True, check=False)
                require(again.returncode == 1 and again.stderr.count("\n") == 1 and "Address already in use" in again.stderr, "a port in use: " + again.stderr.strip())
                for bad in ("0", "70000", "http", "1.2.3.4:", "evil.example:80", "::1:80"):
                    refused = subprocess.run([*command[:3], bad], capture_output=True, text=True, check=False)
                    require(refused.returncode == 2 and "expected a port 1 ... 65535" in refused.stderr, f"--web {bad} is usage")
                in_chromium(work, os.path.realpath(sys.argv[2]) if len(sys.argv) > 2 else work)
                daemon.send_signal(signal.SIGSTOP)
                seen = wait_for(lambda d: "no message for" in d["sensor"]["lines"][0][1], "a daemon that is delayed is seen")["sensor"]
                require(not re.search("running|nothing lost", json.dumps(seen["lines"])) and not any("rate_radps" in axis or axis["allan"] for axis in seen["axes"]),
                        "and nothing of it is shown as of now")
                daemon.send_signal(signal.SIGCONT)
                idle = strangers(monitor)
                began = time.monotonic()
                monitor.send_signal(signal.SIGINT)
                require(monitor.wait(10) == 0 and time.monotonic() - began < 1.5, f"Ctrl-C ends it at once, {len(idle)} clients or not")
            finally:
                for each in (monitor, daemon):
                    if each.poll() is None:
                        each.kill()


main()
