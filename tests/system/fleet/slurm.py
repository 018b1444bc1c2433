#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`ifog fleet --engine slurm` with a real slurmctld and two slurmd on this computer, one of which is killed.

usage: slurm.py PATH_OF_IFOG SOURCE_DIR Exit 77 if slurm-wlm, munge or a network namespace is missing.

All files are in a temporary folder, all sockets in a separate network namespace; processes are ended by their ids.
"""
import contextlib
import getpass
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile

IFOG, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])

import lot  # noqa: E402
from waiting import wait_for  # noqa: E402

GYROS = [f"G{i:02}" for i in range(1, 11)]
INSIDE = "IFOG_FLEET_NAMESPACE"
NODE = "IFOG_FLEET_NODE"  # in the environment of a node's own processes

CONFIGURATION = """
ClusterName=fleet
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort=16817
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdTimeout=5
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName=n[1-2] NodeHostname={host} NodeAddr=127.0.0.1 Port=[17001-17002] CPUs=1 State=UNKNOWN
PartitionName=p Nodes=n[1-2] Default=YES MaxTime=INFINITE State=UP
"""


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(77)


class Cluster:
    def __init__(self, folder):
        self.folder = folder
        self.started = []
        self.nodes = {}
        for name in ("munge", "state", "n1", "n2"):
            (folder / name).mkdir(mode=0o755)
        configuration = folder / "slurm.conf"
        configuration.write_text(CONFIGURATION.format(host=socket.gethostname().split(".")[0], user=getpass.getuser(), folder=folder))
        (folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        self.environment = {**os.environ, "SLURM_CONF": str(configuration)}

    def bring_up(self):
        self.start_munge()
        self.start("slurmctld", "-D")
        wait_for("slurmctld", lambda: self.ran("scontrol", "ping", check=False).returncode == 0)
        self.nodes = {name: self.start("slurmd", "-D", "-N", name, node=name) for name in ("n1", "n2")}
        wait_for("two idle nodes", lambda: self.ran("sinfo", "-h", "-N", "-o", "%t").stdout.split() == ["idle", "idle"])

    def start_munge(self):
        folder = self.folder / "munge"
        key = folder / "key"
        key.touch(mode=0o600)
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={folder}/socket", f"--pid-file={folder}/pid", f"--log-file={folder}/log",
                   f"--seed-file={folder}/seed")
        wait_for("munged", (folder / "socket").exists)

    def start(self, *words, node=None):
        environment = {**self.environment, NODE: node} if node else self.environment
        said = open(self.folder / f"{words[0]}-{node or 'only'}.said", "w")
        process = subprocess.Popen(words, env=environment, stdin=subprocess.DEVNULL, stdout=said, stderr=said)
        said.close()
        self.started.append(process)
        return process

    def ran(self, *words, check=True):
        return subprocess.run(words, env=self.environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=check, timeout=60)

    def processes_of(self, name):
        """Processes of the node: its daemon, their children and its tasks, identified by their environment."""
        found = []
        for entry in pathlib.Path("/proc").iterdir():
            if not entry.name.isdigit() or int(entry.name) == os.getpid():
                continue
            try:
                environment = set((entry / "environ").read_bytes().split(b"\0"))
            except OSError:
                continue
            ours = f"SLURM_CONF={self.environment['SLURM_CONF']}".encode() in environment
            if ours and (f"{NODE}={name}".encode() in environment or f"SLURMD_NODENAME={name}".encode() in environment):
                found.append(int(entry.name))
        return found

    def kill_node(self, name):
        """Like a power failure: no process can clean up."""
        for _ in range(3):
            for process in self.processes_of(name):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
        self.nodes[name].wait(timeout=10)

    def end(self):
        for name in ("n1", "n2"):
            for process in self.processes_of(name):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
        for process in reversed(self.started):
            if process.poll() is None:
                process.terminate()
        for process in self.started:
            try:
                process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def fleet(cluster, *arguments):
    return [IFOG, "fleet", "lot.toml", "--engine", "slurm", *arguments], {"cwd": cluster.folder / "lot", "env": cluster.environment, "stdin": subprocess.DEVNULL, "text": True}


def fleet_said(cluster, *arguments):
    words, options = fleet(cluster, *arguments)
    result = subprocess.run(words, capture_output=True, timeout=400, check=False, **options)
    assert result.returncode == 0, f"exit {result.returncode}: {result.stdout}{result.stderr}"
    return result.stdout


def check_a_node_dies(cluster):
    words, options = fleet(cluster)
    with open(cluster.folder / "said", "w") as said:
        run = subprocess.Popen(words, stdout=said, stderr=said, **options)
    cluster.started.append(run)
    task = wait_for("a task on n1", lambda: cluster.ran("squeue", "-h", "-t", "R", "-w", "n1", "-o", "%i").stdout.split())[0]
    cluster.kill_node("n1")
    results = cluster.folder / "lot/lot.results"
    had = len(list(results.glob("gyros/*/gyro.json")))
    assert had < len(GYROS), "the lot was done before the node died"
    # Slurm waits two minutes for a slow node; this one is known to be dead.
    wait_for("the task is queued again", lambda: "BeginTime" in cluster.ran("squeue", "-h", "-t", "PD", "-j", task, "-o", "%r").stdout, seconds=120)
    cluster.ran("scontrol", "update", f"JobId={task}", "StartTime=now")
    assert run.wait(timeout=500) == 0, (cluster.folder / "said").read_text()
    document = json.loads((results / "fleet.json").read_text())
    assert document["failed"] == [] and document["gyros"] == GYROS, document["failed"]
    assert {path.parent.name for path in results.glob("gyros/*/gyro.json")} == set(GYROS)
    (effect,) = document["effects"]
    assert len(effect["gyros"]) == len(GYROS) and effect["found"] >= 9, effect["found"]
    again = cluster.ran("scontrol", "show", "job", task, check=False).stdout
    controller = (cluster.folder / "slurmctld.log").read_text()
    assert "Restarts=1" in again or "requeue" in controller.lower(), f"task {task} was on the node that died and not requeued: {again}"


def check_the_same_as_on_this_machine(cluster):
    shutil.copytree(cluster.folder / "lot", cluster.folder / "here", ignore=shutil.ignore_patterns("lot.results"), copy_function=shutil.copy2)
    subprocess.run([IFOG, "fleet", "lot.toml", "--engine", "local"], cwd=cluster.folder / "here", check=True, capture_output=True, timeout=300)
    for name in [f"gyros/{gyro}/diagnosis.json" for gyro in GYROS] + ["type.json", "fleet.json"]:
        one, other = (json.loads((cluster.folder / place / "lot.results" / name).read_text()) for place in ("lot", "here"))
        assert one == other, name


def check_restart(cluster):
    assert "submitted" not in fleet_said(cluster), "nothing was missing"
    shutil.rmtree(cluster.folder / "lot/lot.results/gyros/G04")
    assert "#SBATCH --array=3\n" in fleet_said(cluster, "--dry-run")
    assert "submitted" in fleet_said(cluster)
    assert (cluster.folder / "lot/lot.results/gyros/G04/gyro.json").is_file()


def check_an_interrupted_run_is_taken_up(cluster):
    """The array continues after its submitting process ends, and is not submitted twice."""
    shutil.rmtree(cluster.folder / "lot/lot.results")
    words, options = fleet(cluster)
    run = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)
    cluster.started.append(run)
    wait_for("a task", lambda: cluster.ran("squeue", "-h", "-t", "R", "-o", "%i").stdout)
    run.send_signal(signal.SIGINT)
    _, said = run.communicate(timeout=60)
    assert run.returncode == 1 and "takes it up" in said, said
    assert "under way" in fleet_said(cluster)
    assert len(list((cluster.folder / "lot/lot.results").glob("gyros/*/gyro.json"))) == len(GYROS)


def inside():
    failed = 0
    with tempfile.TemporaryDirectory(prefix="fleet") as name:
        folder = pathlib.Path(name)
        (folder / "lot").mkdir()
        # Enough samples that a task lasts long enough to be killed.
        lot.make(IFOG, folder / "lot", gyros=GYROS, hertz=400)
        cluster = None
        try:
            cluster = Cluster(folder)
            cluster.bring_up()  # its processes are ended in any case
            for check in (check_a_node_dies, check_the_same_as_on_this_machine, check_restart, check_an_interrupted_run_is_taken_up):
                try:
                    check(cluster)
                    print(f"ok       {check.__name__[6:].replace('_', ' ')}", flush=True)
                except AssertionError as error:
                    failed += 1
                    print(f"FAILED   {check.__name__[6:].replace('_', ' ')}: {error}", flush=True)
        except AssertionError as error:
            failed += 1
            print(f"FAILED   {error}")
            for path in sorted(folder.glob("*.said")) + sorted(folder.glob("*.log")):
                print(path.name, path.read_text(errors="replace")[-1500:])
        finally:
            if cluster:
                cluster.end()
    return 1 if failed else 0


def main():
    if os.environ.get(INSIDE):
        subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
        # Slurm needs an address that is not on the loopback; one for documentation (RFC 5737).
        subprocess.run(["ip", "address", "add", "192.0.2.1/32", "dev", "lo"], check=True)
        return inside()
    for program in ("slurmctld", "slurmd", "sbatch", "munged", "unshare", "ip"):
        if not shutil.which(program):
            skip(f"no {program} here; tools/install-packages test makes this run")
    unshare = ["unshare", "-n"] if os.geteuid() == 0 else ["unshare", "-rn"]
    if subprocess.run([*unshare, "true"], capture_output=True, check=False).returncode != 0:
        skip("no network namespace can be made here; root or user namespaces make this run")
    return subprocess.run([*unshare, sys.executable, *sys.argv], env={**os.environ, INSIDE: "1"}, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
