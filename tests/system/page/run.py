#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`ifog monitor --web`: the real daemon plays a capture whose figures are known, the page's data is held to them, clients that mean
no good are let at it, and Chromium shows the page at two widths, light and dark.

usage: run.py BINARY_DIR [FOLDER for the pictures]        exit 77, with the reason, where something to run it is missing
"""
import http.client
import http.server
import json
import math
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


def require(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")
    print(f"ok: {what}")


def configure(work, binaries):
    """Each axis is its mean ± SWING by the throw of a coin: standard deviation SWING, Allan deviation of one sample likewise."""
    coin = random.Random(1)
    with open(f"{work}/three.csv", "w", encoding="utf-8") as out:
        out.write("time_s,rate_x_radps,rate_y_radps,rate_z_radps,temperature_degC\n")
        for i in range(120 * RATE_HZ):
            rates = ",".join(f"{mean + coin.choice((-SWING, SWING)):.9e}" for mean in MEANS.values())
            out.write(f"{i / RATE_HZ:.3f},{rates},25\n")
    with open(f"{work}/ifogd.toml", "w", encoding="utf-8") as out:
        out.write(f"""[daemon]
lock_memory = false
plugin_folder = "{binaries}/plugins"
[[sensor]]
name = "nose"
driver = "capture"
nominal_rate_hz = {RATE_HZ}
[sensor.transport]
type = "file"
path = "{work}/three.csv"
bytes_per_second = 5800
pace = "recorded"
[sensor.options]
columns = "rate_x_radps,rate_y_radps,rate_z_radps,temperature_degC"
[sensor.filter]
process_noise = 1e-16
measurement_noise = 1e-14
""")


def ask(path, method="GET", **headers):
    connection = http.client.HTTPConnection("127.0.0.1", PORT, timeout=10)
    connection.request(method, path, headers=headers)
    answer = connection.getresponse()
    return answer.status, dict(answer.getheaders()), answer.read().decode()


def data(sensor=""):
    return json.loads(ask(f"/data?sensor={sensor}")[2])


def wait_for(judge, what, seconds=20):
    end = time.monotonic() + seconds
    while True:
        try:
            if judge(seen := data()):
                print(f"ok: {what}")
                return seen
        except (ConnectionError, KeyError, IndexError):  # it does not listen yet, or shows no sensor
            seen = None
        if time.monotonic() > end:
            sys.exit(f"FAILED: {what}; last {json.dumps(seen)[:2000]}")
        time.sleep(0.2)


def figures():
    """Against the capture's own numbers."""
    seen = wait_for(lambda d: len(d["sensor"]["axes"][2]["allan"]) > 3 and len(d["sensor"]["axes"][0]["seconds"]) > 3, "three axes")
    text = "\n".join(line for _, line in seen["sensor"]["lines"])
    for part in ("running", "nothing lost", "driver capture, file /", "three.csv", "temperature_degC 25"):
        require(part in text, f"the page says {part!r}")
    for axis, (name, mean) in zip(seen["sensor"]["axes"], MEANS.items()):
        close = lambda value, wanted, within: value is not None and abs(value - wanted) < within
        seconds = [(low, high) for low, high, _ in axis["seconds"] if low is not None]
        require(axis["name"] == name and close(axis["rate_radps"], mean, SWING) and close(axis["raw_noise_radps"], SWING, 0.03 * SWING)
                and axis["noise_radps"] < 0.5 * SWING, f"{name}: rate, raw noise, less noise denoised")
        require(len(seconds) > 2 and all(close(low, mean - SWING, 1e-3 * SWING) and close(high, mean + SWING, 1e-3 * SWING)
                                         for low, high in seconds), f"{name}: each second lies between the capture's two values")
        require(close(axis["allan"][0], SWING, 0.15 * SWING) and close(axis["allan"][3], SWING / math.sqrt(8), 0.3 * SWING),
                f"{name}: Allan deviation of one sample and of eight")
    before, began = seen["sensor"]["axes"][1]["angle_rad"], time.monotonic()
    time.sleep(3)
    turned = data()["sensor"]["axes"][1]["angle_rad"] - before
    require(abs(turned / (MEANS["y"] * (time.monotonic() - began)) - 1) < 0.4, "the angle goes on by rate times time")


def strangers(monitor):
    """Read only, for few, and never in the way."""
    status, headers, _ = ask("/")
    require(status == 200 and "default-src 'none'" in headers["Content-Security-Policy"], "the page, which may load nothing from elsewhere")
    for name in ("page.js", "page.css"):
        text = ask(f"/{name}")[2]
        require("innerHTML" not in text and not re.search(r"https?:|@import|url\(", text), f"{name}: no innerHTML, nothing of the network")
    for method, path, host, wanted in (("POST", "/", "localhost", 405), ("GET", "/../etc/passwd", "localhost", 404), ("GET", "/data", "evil.example", 403),
                                       ("GET", "/data", "127.evil.example:80", 403), ("GET", "/data", f"[::1]:{PORT}", 200)):
        require(ask(path, method, Host=host)[0] == wanted, f"{method} {path} for {host}: {wanted}")
    many = ask("/page.js", Range="bytes=" + ",".join(["0-"] * 2000))
    require(many[0] == 200 and len(many[2]) < 20000, "two thousand ranges are one answer")
    resident = lambda: int(re.search(r"VmRSS:\s*(\d+)", pathlib.Path(f"/proc/{monitor.pid}/status").read_text(encoding="utf-8"))[1])
    for _ in range(200):
        ask("/data?sensor=" + "x" * 4000)
    before = resident()
    for _ in range(1000):
        ask("/data?sensor=" + "x" * 4000)
    require(resident() - before < 4000, f"a thousand questions more, {resident() - before} kB more")
    idle = [socket.create_connection(("127.0.0.1", PORT)) for _ in range(40)]
    for each in idle[:20]:
        each.send(b"GET / HTTP/1.1\r\nX: ")
    descriptors = len(os.listdir(f"/proc/{monitor.pid}/fd"))
    require(descriptors < 40, f"40 that say nothing: {descriptors} descriptors")
    began = time.monotonic()
    require(ask("/")[0] == 200, f"and the page comes, after {time.monotonic() - began:.0f} s")
    return idle


class Stand(http.server.BaseHTTPRequestHandler):
    """The monitor's own page in frames, with data as it was or with names that mean no good."""
    foreign, stopped = None, False

    def do_GET(self):  # pylint: disable=invalid-name
        if self.path == "/frames":
            body, kind = FRAMES, "text/html"
        elif self.path.startswith("/data"):
            body, kind = (json.dumps(Stand.foreign) if Stand.foreign else ask(self.path)[2]), "application/json"
        else:
            _, headers, body = ask(self.path)
            kind = headers["Content-Type"]
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.end_headers()
        self.wfile.write(body.encode())

    def log_message(self, *_):
        pass


FRAMES = """<!DOCTYPE html><meta charset="utf-8"><body style="margin:0;background:#888"><script>
const out = [], frames = [960, 390].map(width => { const f = document.createElement('iframe'); f.src = '/';
  f.style = `width:${width}px;height:1500px;border:0;margin-right:8px`; document.body.append(f); return f; });
setTimeout(() => { for (const f of frames) { const d = f.contentDocument, box = d.documentElement;
  out.push({width: f.clientWidth, over: box.scrollWidth - box.clientWidth, canvases: d.querySelectorAll('canvas').length, images: d.images.length,
    drawn: [...d.querySelectorAll('canvas')].filter(c => c.width && new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer).some(v => v)).length,
    text: d.body.innerText}); }
  document.title = 'done'; if (location.hash) document.body.textContent = 'RESULT' + JSON.stringify(out) + 'END'; }, 4000);
</script>"""


def browse(browser, work, *arguments):
    result = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update",
                             "--disable-sync", "--disable-dev-shm-usage", f"--user-data-dir={work}/profile", "--enable-logging=stderr", "--window-size=1400,1500",
                             "--virtual-time-budget=8000", *arguments], capture_output=True, text=True, timeout=90, check=False)
    told = [line for line in result.stderr.splitlines() if "CONSOLE" in line and "source: chrome:" not in line]
    require(not told, f"no message on the console {told or ''}")
    return result.stdout


def in_chromium(work, pictures):
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if not browser:
        print("SKIPPED in part: no chromium here; tools/install-packages test makes this run")
        return
    stand = http.server.ThreadingHTTPServer(("127.0.0.1", PORT + 1), Stand)
    threading.Thread(target=stand.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{PORT + 1}/frames"
    look = lambda: json.loads(re.search("RESULT(.*)END", browse(browser, work, "--dump-dom", address + "#say"), re.S)[1].replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
    for seen in look():
        require(seen["over"] <= 0 and seen["canvases"] == seen["drawn"] == 4 and "running" in seen["text"] and "x 2.0" in seen["text"],
                f"{seen['width']} px: nothing wider, four pictures drawn, figures there")
    for scheme in ("light", "dark"):
        browse(browser, work, f"--screenshot={pictures}/{scheme}.png", f"--blink-settings=preferredColorScheme={int(scheme == 'light')}", address)
    require(pathlib.Path(f"{pictures}/light.png").read_bytes() != pathlib.Path(f"{pictures}/dark.png").read_bytes(), "dark looks other than light")
    Stand.foreign = data()
    Stand.foreign["sensors"] = [[FOREIGN, "good"]]
    Stand.foreign["sensor"]["lines"].append(["bad", FOREIGN])
    Stand.foreign["sensor"]["axes"][0]["name"] = FOREIGN
    for seen in look():
        require(seen["images"] == 0 and seen["text"].count(FOREIGN) == 3, f"{seen['width']} px: foreign names are text")
    Stand.foreign["age_s"] = 60
    for seen in look():
        require("held up for 60 s" in seen["text"] and "x 2.0" not in seen["text"] and "running" not in seen["text"], f"{seen['width']} px: old figures are not shown")
    stand.shutdown()


def main():
    private_network.enter()
    binaries = os.path.realpath(sys.argv[1])
    ifog = f"{binaries}/tools/ifog/ifog"
    with tempfile.TemporaryDirectory() as work:
        configure(work, binaries)
        command = [ifog, "monitor", "--web", str(PORT), "--config", f"{work}/ifogd.toml"]
        with open(f"{work}/log", "w", encoding="utf-8") as log, subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as monitor, \
                subprocess.Popen([f"{binaries}/daemon/ifogd", "--config", f"{work}/ifogd.toml"], stdout=log, stderr=log) as daemon:
            try:
                require(f"http://localhost:{PORT}/" in monitor.stdout.readline(), "it says where")
                figures()
                again = subprocess.run(command, capture_output=True, text=True, check=False)
                require(again.returncode == 1 and again.stderr.count("\n") == 1 and "Address already in use" in again.stderr, "a port in use: " + again.stderr.strip())
                in_chromium(work, os.path.realpath(sys.argv[2]) if len(sys.argv) > 2 else work)
                daemon.send_signal(signal.SIGSTOP)
                seen = wait_for(lambda d: "no message for" in d["sensor"]["lines"][0][1], "a daemon that is held up is seen")
                text = json.dumps(seen["sensor"]["lines"])
                require("running" not in text and "nothing lost" not in text and not any("rate_radps" in axis or axis["allan"] for axis in seen["sensor"]["axes"]),
                        "and nothing of it is shown as of now")
                daemon.send_signal(signal.SIGCONT)
                idle = strangers(monitor)
                began = time.monotonic()
                monitor.send_signal(signal.SIGINT)
                require(monitor.wait(10) == 0 and time.monotonic() - began < 1.5, f"Ctrl-C ends it in {time.monotonic() - began:.1f} s, {len(idle)} clients or not")
            finally:
                for each in (monitor, daemon):
                    if each.poll() is None:
                        each.kill()


main()
