# SPDX-License-Identifier: Apache-2.0
"""An emulated navigation computer: Debian's kernel and systemd in QEMU, controlled from the host.

The host runs commands through a virtio port, connects to the serial lines as unix sockets, and removes and adds devices through
QEMU's monitor (QMP).
"""
import base64
import json
import os
import shutil
import socket
import subprocess
import time


class Failure(Exception):
    """A failed check; the text has the observed and the expected value."""


def connect(path, seconds):
    """A unix socket that QEMU makes at start-up."""
    deadline = time.monotonic() + seconds
    while True:
        try:
            link = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            link.connect(path)
            return link
        except OSError:
            link.close()
            if time.monotonic() > deadline:
                raise Failure(f"nothing listens on {path} after {seconds} s")
            time.sleep(0.05)


class Lines:
    """Lines over a socket, with a time limit on each."""

    def __init__(self, link):
        self.link, self.buffer = link, b""

    def read(self, seconds):
        deadline = time.monotonic() + seconds
        while b"\n" not in self.buffer:
            left = deadline - time.monotonic()
            if left <= 0:
                raise Failure(f"no answer within {seconds} s")
            self.link.settimeout(left)
            try:
                got = self.link.recv(65536)
            except TimeoutError:
                continue
            if not got:
                raise Failure("the machine closed the line")
            self.buffer += got
        line, self.buffer = self.buffer.split(b"\n", 1)
        return line


class Machine:
    """image: folder made by make_image. overlay: files copied over the machine's root. work: for sockets and logs."""

    def __init__(self, image, overlay, work):
        os.makedirs(work, exist_ok=True)
        self.work = work
        for name in ("shell", "qmp", "ttyS1", "ttyUSB0"):
            if os.path.exists(self.path(name)):
                os.unlink(self.path(name))
        initrd = self.path("initrd")
        shutil.copyfile(os.path.join(image, "root.cpio"), initrd)
        # The kernel unpacks successive archives; later files replace earlier ones.
        with open(initrd, "ab") as archive:
            names = subprocess.run(["find", ".", "-print0"], cwd=overlay, check=True, stdout=subprocess.PIPE).stdout
            subprocess.run(["cpio", "--null", "--quiet", "-o", "-H", "newc", "-R", "0:0"], cwd=overlay, input=names, stdout=archive, check=True)
        # Higher priority than the host's other work if allowed, so that its load does not delay the service.
        # If the kernel groups processes by session, the group's niceness counts.
        ahead = ["nice", "-n", "-10", "sh", "-c", "echo -10 2>/dev/null >/proc/self/autogroup; exec \"$@\"", "sh"] if os.geteuid() == 0 else []
        self.process = subprocess.Popen(
            ahead + ["qemu-system-x86_64", "-accel", "tcg,thread=multi", "-cpu", "max", "-smp", "2", "-m", "1536",
             "-nodefaults", "-display", "none", "-no-reboot", "-kernel", os.path.join(image, "vmlinuz"), "-initrd", initrd,
             "-append", "rdinit=/lib/systemd/systemd console=ttyS0 panic=1 quiet systemd.show_status=0 net.ifnames=0 mitigations=off",
             "-serial", "file:" + self.path("console.log"),
             # The sensor's lines: an emulated 8250 and a removable USB converter.
             "-serial", f"unix:{self.path('ttyS1')},server=on,wait=off",
             "-device", "piix3-usb-uhci,id=usb",
             "-chardev", f"socket,id=usbline,path={self.path('ttyUSB0')},server=on,wait=off",
             "-device", "usb-serial,chardev=usbline,id=usbserial,always-plugged=on",
             "-device", "virtio-rng-pci", "-device", "virtio-serial-pci",
             "-chardev", f"socket,id=shell,path={self.path('shell')},server=on,wait=off",
             "-device", "virtserialport,chardev=shell,name=shell",
             "-qmp", f"unix:{self.path('qmp')},server=on,wait=off"],
            stdin=subprocess.DEVNULL, stdout=open(self.path("qemu.log"), "wb"), stderr=subprocess.STDOUT, start_new_session=True)
        self.monitor = Lines(connect(self.path("qmp"), 20))
        self.monitor.read(20)
        self.qmp("qmp_capabilities")
        self.shell = Lines(connect(self.path("shell"), 20))

    def path(self, name):
        return os.path.join(self.work, name)

    def qmp(self, command, **arguments):
        """Runs a monitor command; returns the events before its answer."""
        self.monitor.link.sendall(json.dumps({"execute": command, "arguments": arguments}).encode() + b"\n")
        events = []
        while True:
            answer = json.loads(self.monitor.read(30))
            if "event" in answer:
                events.append(answer)
            elif "error" in answer:
                raise Failure(f"{command}: {answer['error']['desc']}")
            else:
                return events

    def pull(self, device):
        """Removes the device and waits until the machine has released it."""
        events = self.qmp("device_del", id=device)
        deadline = time.monotonic() + 30
        while not any(e["event"] == "DEVICE_DELETED" and e["data"].get("device") == device for e in events):
            if time.monotonic() > deadline:
                raise Failure(f"{device} was not let go within 30 s")
            answer = json.loads(self.monitor.read(30))
            if "event" in answer:
                events.append(answer)

    def plug(self, device, **properties):
        self.qmp("device_add", driver=device, **properties)

    def run(self, command, seconds=180, check=True):
        """Runs a shell command in the machine and returns its output. Raises Failure if it fails and check is set."""
        self.shell.link.sendall(base64.b64encode(command.encode()) + b"\n")
        status, _, output = self.shell.read(seconds).decode().partition(" ")
        output = base64.b64decode(output).decode(errors="replace")
        if check and status != "0":
            raise Failure(f"`{command[:200]}` exited {status}: {output.strip()[-1500:]}")
        return output

    def stop(self):
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(10)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
