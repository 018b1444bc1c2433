# SPDX-License-Identifier: Apache-2.0
"""Description of the machine of a measurement."""
import os
import platform
import subprocess


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


def real_time():
    """Command prefix to run a program with SCHED_FIFO, as the service does; empty if not allowed."""
    words = ["chrt", "-f", "10"]
    return words if subprocess.run([*words, "true"], capture_output=True).returncode == 0 else []
