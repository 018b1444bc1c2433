# SPDX-License-Identifier: Apache-2.0
"""What a figure was measured on, and the network namespace of its own that a program which sends on LCM is measured in."""
import os
import platform
import subprocess
import sys


def machine():
    name = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), platform.machine())
    return {"processor": name, "processors": os.cpu_count(), "kernel": platform.release(), "load": os.getloadavg()[0]}


def machine_line(about):
    return (f"{about['processors']} × {about['processor']}, Linux {about['kernel']}; load average at the end {about['load']:.1f}; "
            f"at {about['commit']}.")


def commit():
    here = os.path.dirname(os.path.abspath(__file__))
    said = subprocess.run(["git", "-C", here, "describe", "--always", "--dirty"], capture_output=True, text=True)
    return said.stdout.strip() or "no commit"


def private_network():
    """This process again, in a network namespace where LCM may send."""
    if os.environ.get("IFOG_BENCH_INSIDE") == "1":
        subprocess.run("ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo", shell=True, check=True)
        return
    flags = "-n" if os.geteuid() == 0 else "-rn"
    os.environ["IFOG_BENCH_INSIDE"] = "1"
    os.execvp("unshare", ["unshare", flags, sys.executable, *sys.argv])


def real_time():
    """Words that run a program as the service runs: with SCHED_FIFO; none where that is not allowed."""
    words = ["chrt", "-f", "10"]
    return words if subprocess.run([*words, "true"], capture_output=True).returncode == 0 else []
